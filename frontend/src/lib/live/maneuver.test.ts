import { expect, it } from "vitest";
import { addStates } from "./maneuver";

/** A state of a maneuver that began at `begin`, with the estimate of an earlier time. */
const state = (time_s: number, begin: number | null, estimated_s: number | null = time_s) => ({
  time_s,
  maneuver_s: begin === null ? 0 : time_s - begin,
  estimate: estimated_s === null ? null : { time_s: estimated_s },
});
const times = (states: readonly { time_s: number }[]) => states.map((one) => one.time_s);

it("puts states in the order of time, each once, also when a history follows them", () => {
  const live = addStates([state(7, 1.95)], [state(8, 1.95)]);
  expect(
    times(
      addStates(
        live,
        [5, 6, 7].map((time) => state(time, 1.95)),
      ),
    ),
  ).toEqual([5, 6, 7, 8]);
});

it("starts anew with a maneuver, and ignores what is left of the one before", () => {
  const second = addStates([state(30, 2), state(31, 2)], [state(62, 60, null)]);
  expect(times(second)).toEqual([62]);
  expect(times(addStates(second, [state(31, 2)]))).toEqual([62]);
});

it("has only the present state before a maneuver, and does not grow after it", () => {
  expect(times(addStates([state(1, null, null)], [state(2, null, null)]))).toEqual([2]);
  let states: readonly ReturnType<typeof state>[] = [state(29, 2), state(30, 2)];
  for (let time = 31; time < 4000; time++) states = addStates(states, [state(time, 2, 30)]);
  expect(times(states)).toEqual([29, 3999]);
});

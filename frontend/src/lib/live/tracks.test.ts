import { expect, it } from "vitest";
import { trackModes } from "./tracks";

const mode = (name: string, damping: number, damping_std: number | null = 0.01) => ({
  name,
  damping,
  damping_std,
  frequency: 18,
  frequency_std: 0.1,
});
const state = (time_s: number, modes: ReturnType<typeof mode>[], converged = true) => ({
  estimate: { time_s, converged, modes },
});

it("follows every mode with two standard errors, also one that comes later", () => {
  const { times, tracks } = trackModes(
    [state(5, [mode("SP", 0.5)]), state(6, [mode("SP", 0.4), mode("SW1B", -0.02, null)])],
    "damping",
  );
  expect(times).toEqual([5, 6]);
  expect(tracks.map((track) => track.name)).toEqual(["SP", "SW1B"]);
  expect(tracks[0]?.values).toEqual([0.5, 0.4]);
  expect(tracks[0]?.low[1]).toBeCloseTo(0.38);
  expect(tracks[0]?.high[1]).toBeCloseTo(0.42);
  expect(tracks[1]?.values).toEqual([null, -0.02]);
  expect(tracks[1]?.low).toEqual([null, null]); // no interval without a standard error
});

it("draws no estimate that did not converge", () => {
  const states = [state(5, [mode("SP", 0.5)]), state(6, [mode("SP", 9)], false)];
  expect(trackModes(states, "damping").times).toEqual([5]);
  expect(trackModes([{ estimate: null }], "damping").times).toEqual([]);
});

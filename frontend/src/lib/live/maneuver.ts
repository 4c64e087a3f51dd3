/** States of the present maneuver of a stream, as they arrive: again, out of order, or anew. */

interface State {
  time_s: number;
  /** Time since the maneuver began; zero before. [s] */
  maneuver_s: number;
  estimate: { time_s: number } | null;
}

/** Beginnings of maneuvers that are nearer than this are one. [s] */
const ALIKE_S = 0.5;

const begin = (state: State) => state.time_s - state.maneuver_s;

/**
 * States of the newest maneuver in the order of time, one for each estimate. A state without a
 * new estimate replaces the one before, so that memory does not grow after a maneuver.
 */
export function addStates<S extends State>(states: readonly S[], more: readonly S[]): readonly S[] {
  const all = [...states, ...more].sort((one, other) => one.time_s - other.time_s);
  const newest = all.at(-1);
  if (newest === undefined) return states;
  const own = all.filter((state) => Math.abs(begin(state) - begin(newest)) < ALIKE_S);
  return [...new Map(own.map((state) => [state.estimate?.time_s ?? null, state])).values()];
}

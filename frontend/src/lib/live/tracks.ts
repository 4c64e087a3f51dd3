/** Modes of all estimates of a maneuver over time, with intervals of two standard errors. */

interface Mode {
  name: string;
  frequency: number;
  frequency_std: number | null;
  damping: number;
  damping_std: number | null;
}

interface State {
  /** The newest estimate, and the end of its record. [s] */
  estimate: { time_s: number; converged: boolean; modes: readonly Mode[] } | null;
}

/** One quantity of one mode; null where it was not estimated. */
export interface Track {
  name: string;
  values: (number | null)[];
  low: (number | null)[];
  high: (number | null)[];
}

export interface Tracks {
  times: number[];
  tracks: Track[];
}

/** Values of every mode, times a factor, at the times of all estimates that converged. */
export function trackModes(
  states: readonly State[],
  quantity: "damping" | "frequency",
  factor = 1,
): Tracks {
  const estimates = states.flatMap(({ estimate }) => (estimate?.converged ? [estimate] : []));
  const names = new Set(estimates.flatMap(({ modes }) => modes.map((mode) => mode.name)));
  return {
    times: estimates.map((estimate) => estimate.time_s),
    tracks: [...names].map((name) => {
      const found = estimates.map(({ modes }) => modes.find((mode) => mode.name === name));
      const at = (sigmas: number) =>
        found.map((mode) => {
          const std = mode?.[`${quantity}_std`];
          if (mode === undefined || (sigmas !== 0 && std == null)) return null;
          return factor * (mode[quantity] + sigmas * (std ?? 0));
        });
      return { name, values: at(0), low: at(-2), high: at(2) };
    }),
  };
}

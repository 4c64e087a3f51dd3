/** What an analyst has chosen for a new run, before it is sent. */
import { derivativeNames } from "./derivatives";

export const STARTS = [
  "best",
  "equation-error",
  "prediction",
  "residualized-prediction",
  "run",
] as const;
export type Start = (typeof STARTS)[number];

export interface RunDraft {
  methods: ("OE" | "FRE" | "EE")[];
  modes: number[];
  /** Empty: all that the maneuver has. */
  inputs: string[];
  outputs: string[];
  /**
   * Derivatives that are not estimated. Kept instead of the free ones, so that a
   * mode or input added later comes with all its derivatives free.
   */
  held: string[];
  start: Start;
  /** Limits in Hz as they are typed; empty: the whole excited band. */
  band: [string, string];
  freeDelays: boolean;
  /** The other predicted modes move too, with their derivatives held. */
  carryModes: boolean;
  /** Quantities beyond the derivatives: `delay_q`, `scale_alpha`, `omega_7`, `zeta_7`. */
  alsoFree: string[];
  noise: "diagonal" | "full";
  /** Spread of priors at the prediction, as a share of each value; null: no priors. */
  priorSpread: number | null;
  maxIterations: number;
  modalTable: number | null;
  dampingTable: number | null;
  prediction: number | null;
}

export const EMPTY_DRAFT: RunDraft = {
  methods: ["OE"],
  modes: [],
  inputs: [],
  outputs: [],
  held: [],
  start: "best",
  band: ["", ""],
  freeDelays: false,
  carryModes: false,
  alsoFree: [],
  noise: "diagonal",
  priorSpread: null,
  maxIterations: 100,
  modalTable: null,
  dampingTable: null,
  prediction: null,
};

/** Free derivatives of the chosen modes and inputs; null when all of them are. */
export function freeDerivatives(draft: RunDraft, inputs: readonly string[]): string[] | null {
  const all = derivativeNames(draft.modes, inputs);
  const free = all.filter((name) => !draft.held.includes(name));
  return free.length === all.length ? null : free;
}

/** Modes that a prediction knows and a draft does not estimate. */
export function carriedModes(
  draft: RunDraft,
  symmetric: readonly number[],
  predicted: readonly string[],
): number[] {
  if (!draft.carryModes) return [];
  return symmetric.filter(
    (mode) => !draft.modes.includes(mode) && predicted.includes(`CQ${String(mode)}_alpha`),
  );
}

export function holdAllBut(
  draft: RunDraft,
  inputs: readonly string[],
  free: readonly string[] | null,
): RunDraft {
  if (free === null) return { ...draft, held: [] };
  const all = derivativeNames(draft.modes, inputs);
  return { ...draft, held: all.filter((name) => !free.includes(name)) };
}

/** The band in Hz, null for the whole band, or the reason why it cannot be used. */
export function bandOf(draft: RunDraft): { band: [number, number] | null } | { fault: string } {
  const [low, high] = draft.band.map((text) => text.trim().replace(",", "."));
  if (!low && !high) return { band: null };
  const from = Number(low);
  const to = Number(high);
  if (!low || !high || !Number.isFinite(from) || !Number.isFinite(to)) {
    return { fault: "Give both limits as numbers, or leave both empty." };
  }
  if (from < 0 || to <= from) return { fault: "The upper limit must lie above the lower one." };
  return { band: [from, to] };
}

/** Why the draft cannot be sent yet; null when it can. */
export function draftFault(draft: RunDraft): string | null {
  if (draft.methods.length === 0) return "Choose at least one method.";
  const band = bandOf(draft);
  if ("fault" in band) return band.fault;
  if (/prediction/.test(draft.start) && draft.prediction === null) {
    return "Choose the prediction to start from.";
  }
  if (draft.priorSpread !== null && draft.prediction === null) {
    return "Choose the prediction that the priors stand at.";
  }
  return null;
}

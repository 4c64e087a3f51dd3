/** Draft of a new run. */
import { axisNames, derivativeNames } from "../derivatives";
import { heldAt, stateOf, type FixedTo, type States, type Structure } from "../structure";

export const STARTS = [
  "best",
  "equation-error",
  "prediction",
  "residualized-prediction",
  "run",
] as const;
export type Start = (typeof STARTS)[number];

export const OUT_OF_BAND_MODES = ["retained", "held", "omitted"] as const;
type OutOfBandModes = (typeof OUT_OF_BAND_MODES)[number];

export interface RunDraft {
  methods: ("OE" | "FRE" | "EE")[];
  modes: number[];
  /** Axis of the maneuver. */
  axis: string;
  /** Empty: all that the maneuver has. */
  inputs: string[];
  outputs: string[];
  /**
   * Derivatives that are not estimated. Stored instead of the free ones, so that a
   * mode or input added later comes with all its derivatives free.
   */
  held: string[];
  absent: string[];
  /** Held at a number, or at a prediction or earlier run. */
  fixed: Record<string, number>;
  fixedTo: Record<string, FixedTo>;
  /** Delays [s] and instruments of channels, where other than the aircraft's. */
  delays: Record<string, number>;
  instruments: Record<string, string | null>;
  start: Start;
  /** Limits in Hz as they are typed; empty: the whole excited band. */
  band: [string, string];
  freeDelays: boolean;
  /** The modes that are not estimated: nuisance parameters, held as predicted, or none. */
  outOfBandModes: OutOfBandModes;
  /** Quantities beyond the derivatives: `delay_q`, `scale_alpha`, `omega_7`, `zeta_7`. */
  extraParameters: string[];
  /** Derivatives constant, or with the frequency shape of a computed prediction. */
  aerodynamics: "quasi-steady" | "shaped";
  noise: "diagonal" | "full";
  /** Spread of priors at the prediction, as a share of each value; null: no priors. */
  priorSpread: number | null;
  maxIterations: number;
  modalTable: number | null;
  dampingTable: number | null;
  prediction: number | null;
}

export const EMPTY_DRAFT: RunDraft = {
  axis: "longitudinal",
  methods: ["OE"],
  modes: [],
  inputs: [],
  outputs: [],
  held: [],
  absent: [],
  fixed: {},
  fixedTo: {},
  delays: {},
  instruments: {},
  start: "best",
  band: ["", ""],
  freeDelays: false,
  outOfBandModes: "retained",
  aerodynamics: "quasi-steady",
  extraParameters: [],
  noise: "diagonal",
  priorSpread: null,
  maxIterations: 100,
  modalTable: null,
  dampingTable: null,
  prediction: null,
};

/** State of each derivative of the selected modes and inputs. */
export function statesOf(draft: RunDraft, inputs: readonly string[]): States {
  const all = derivativeNames(draft.modes, inputs, draft.axis);
  const known = <T>(record: Record<string, T>) =>
    Object.fromEntries(Object.entries(record).filter(([name]) => all.includes(name)));
  const states = {
    absent: draft.absent.filter((name) => all.includes(name)),
    fixed: known(draft.fixed),
    fixed_to: known(draft.fixedTo),
  };
  const rest = all.filter((name) => stateOf({ ...states, free: null }, name) === "free");
  const free = rest.filter((name) => !draft.held.includes(name));
  return { ...states, free: free.length === rest.length ? null : free };
}

/** The draft with other states of its derivatives. */
export function withStates(draft: RunDraft, inputs: readonly string[], states: States): RunDraft {
  const all = derivativeNames(draft.modes, inputs, draft.axis);
  return {
    ...draft,
    absent: states.absent,
    fixed: states.fixed,
    fixedTo: states.fixed_to,
    held: all.filter(
      (name) => stateOf(states, name) === "fixed" && heldAt(states, name).source === "start",
    ),
  };
}

/** The draft with a whole structure in place of its own. */
export function withStructure(
  draft: RunDraft,
  excited: readonly string[],
  structure: Structure,
): RunDraft {
  const changed: RunDraft = {
    ...draft,
    modes: structure.modes,
    axis: structure.axis,
    inputs: structure.inputs,
    outputs: structure.outputs,
    freeDelays: structure.free_delays,
    extraParameters: structure.extra_parameters,
    delays: structure.delays,
    instruments: structure.instruments,
    // Modes that are held are among those of the structure.
    outOfBandModes: draft.outOfBandModes === "held" ? "omitted" : draft.outOfBandModes,
  };
  return withStates(changed, structure.inputs.length > 0 ? structure.inputs : excited, structure);
}

/** The structure that a draft describes. */
export function structureOf(draft: RunDraft, excited: readonly string[]): Structure {
  const states = statesOf(draft, draft.inputs.length > 0 ? draft.inputs : excited);
  return {
    ...states,
    modes: draft.modes,
    inputs: draft.inputs,
    outputs: draft.outputs,
    free_delays: draft.freeDelays,
    extra_parameters: draft.extraParameters,
    axis: draft.axis,
    delays: draft.delays,
    instruments: draft.instruments,
  };
}

/** Modes that a draft holds as predicted. */
export function listOutOfBandModes(
  draft: RunDraft,
  ofAxis: readonly number[],
  predicted: readonly string[],
): number[] {
  if (draft.outOfBandModes !== "held") return [];
  return ofAxis.filter(
    (mode) =>
      !draft.modes.includes(mode) &&
      predicted.includes(`CQ${String(mode)}_${axisNames(draft.axis).motions[0] ?? ""}`),
  );
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
  if (draft.methods.length === 0) return "Select at least one method.";
  const band = bandOf(draft);
  if ("fault" in band) return band.fault;
  if (/prediction/.test(draft.start) && draft.prediction === null) {
    return "Select the prediction to start from.";
  }
  return null;
}

/** From a draft to a request, and from an earlier run back to a draft. */
import type { Maneuver, ModalTable, Prediction, Run, RunRequest } from "../api/types";
import { excitedInputs } from "../lib/channels";
import { derivativeNames } from "../lib/derivatives";
import {
  bandOf,
  EMPTY_DRAFT,
  freeDerivatives,
  holdAllBut,
  STARTS,
  type RunDraft,
} from "../lib/runDraft";

/** The draft as the API takes it; what the form does not show is kept from the earlier run. */
export function runRequest(
  draft: RunDraft,
  method: RunRequest["method"],
  maneuver: number,
  excited: string[],
  { like, together, carried = [] }: { like?: Run; together?: number[]; carried?: number[] },
): RunRequest {
  const band = bandOf(draft);
  const inputs = draft.inputs.length > 0 ? draft.inputs : excited;
  const free = freeDerivatives(draft, inputs);
  return {
    author: "",
    maneuver_id: maneuver,
    method,
    structure: {
      modes: [...draft.modes, ...carried],
      inputs: draft.inputs,
      outputs: draft.outputs,
      free: free ?? (carried.length > 0 ? derivativeNames(draft.modes, inputs) : null),
      fixed: like?.structure.fixed ?? {},
      free_delays: draft.freeDelays,
      also_free: draft.alsoFree,
      axis: "longitudinal",
      absent: like?.structure.absent ?? [],
      fixed_to: like?.structure.fixed_to ?? {},
      delays: like?.structure.delays ?? {},
      instruments: like?.structure.instruments ?? {},
    },
    settings: {
      start: draft.start,
      band_hz: "band" in band ? band.band : null,
      max_iterations: draft.maxIterations,
      noise: draft.noise,
      start_run_id: draft.start === "run" ? like?.id : null,
      priors: Object.fromEntries(
        Object.entries(like?.settings.priors ?? {}).map(([name, [value = 0, spread = 1]]) => [
          name,
          [value, spread] as [number, number],
        ]),
      ),
      prior_spread: draft.priorSpread,
      together_with: together ?? like?.settings.together_with ?? [],
    },
    modal_table_id: draft.modalTable,
    damping_table_id: draft.dampingTable,
    prediction_id: draft.prediction,
  };
}

interface Beginning {
  maneuver: Maneuver;
  tables: ModalTable[];
  predictions: Prediction[];
  like?: Run;
  methods?: RunDraft["methods"];
}

/** The choices of an earlier run, or defaults that suit the maneuver. */
export function firstDraft({ maneuver, tables, predictions, like, methods }: Beginning): RunDraft {
  const modal = tables.find((one) => one.kind === "FEM");
  const sources = {
    modalTable: modal?.id ?? null,
    dampingTable: tables.find((one) => one.kind === "GVT")?.id ?? null,
    prediction: predictions[0]?.id ?? null,
  };
  if (like === undefined) {
    const symmetric = modal?.numbers.filter((_, place) => modal.symmetric[place]) ?? [];
    return {
      ...EMPTY_DRAFT,
      ...sources,
      modes: symmetric.slice(0, 2),
      ...(methods && methods.length > 0 ? { methods } : {}),
    };
  }
  const { structure, settings } = like;
  const draft: RunDraft = {
    methods: [like.method],
    modes: structure.modes,
    inputs: structure.inputs,
    outputs: structure.outputs,
    held: [],
    start: STARTS.find((one) => one === settings.start) ?? "best",
    band: [String(settings.band_hz?.[0] ?? ""), String(settings.band_hz?.[1] ?? "")],
    freeDelays: structure.free_delays,
    carryModes: false, // the run before names them among its modes
    alsoFree: structure.also_free,
    noise: settings.noise === "full" ? "full" : "diagonal",
    priorSpread: settings.prior_spread,
    maxIterations: settings.max_iterations,
    modalTable: like.modal_table_id ?? sources.modalTable,
    dampingTable: like.damping_table_id,
    prediction: like.prediction_id ?? sources.prediction,
  };
  const inputs = draft.inputs.length > 0 ? draft.inputs : excitedInputs(maneuver);
  return holdAllBut(draft, inputs, structure.free ?? null);
}

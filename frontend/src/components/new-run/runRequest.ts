/** From a draft to a request, and from an earlier run back to a draft. */
import {
  MODEL_AXES,
  type Maneuver,
  type ModalTable,
  type ModelAxis,
  type Prediction,
  type Run,
  type RunProposal,
  type BatchRequest,
  type RunRequest,
  type RunTemplate,
  type StructureVersion as Origin,
} from "../../api/types";
import { excitedInputs } from "../../lib/channels";
import { derivativeNames } from "../../lib/derivatives";
import {
  bandOf,
  EMPTY_DRAFT,
  STARTS,
  structureOf,
  withStructure,
  type RunDraft,
} from "../../lib/drafts/runDraft";
import { stateOf, type Structure } from "../../lib/structure";

/** The axis of a model; that of ground records and combined maneuvers is the longitudinal one. */
export const asAxis = (axis: string): ModelAxis =>
  MODEL_AXES.find((one) => one === axis) ?? "longitudinal";

interface RunContext {
  template?: Run;
  /** Template of runs that the draft started from. */
  runTemplate?: RunTemplate;
  /** Stored structure that the run refers to. */
  origin?: Origin;
  additionalManeuvers?: number[];
  outOfBand?: number[];
}

/** Request of a draft; settings that the form does not show are those of the earlier run. */
export function runRequest(
  draft: RunDraft,
  method: RunRequest["method"],
  maneuver: number,
  excited: string[],
  { template, runTemplate, origin, additionalManeuvers, outOfBand = [] }: RunContext,
): RunRequest {
  const band = bandOf(draft);
  const inputs = draft.inputs.length > 0 ? draft.inputs : excited;
  const structure = structureOf(draft, excited);
  const stored = outOfBand.length === 0 ? origin : undefined;
  const { free } = structure;
  return {
    author: "",
    priority: 0,
    maneuver_id: maneuver,
    method,
    ...(stored !== undefined
      ? { structure_id: stored.structure_id, structure_version: stored.version }
      : {
          structure: {
            ...structure,
            axis: asAxis(draft.axis),
            modes: [...draft.modes, ...outOfBand],
            free: outOfBand.length > 0 ? (free ?? freeNames(structure, inputs)) : free,
          },
        }),
    settings: {
      start: draft.start,
      band_hz: "band" in band ? band.band : null,
      max_iterations: draft.maxIterations,
      noise: draft.noise,
      start_run_id: draft.start === "run" ? template?.id : null,
      priors: Object.fromEntries(
        Object.entries(template?.settings.priors ?? {}).map(([name, [value = 0, spread = 1]]) => [
          name,
          [value, spread] as [number, number],
        ]),
      ),
      prior_spread: draft.priorSpread,
      out_of_band_modes: draft.outOfBandModes === "retained" ? "retained" : "omitted",
      aerodynamics: draft.aerodynamics,
      additional_maneuver_ids:
        additionalManeuvers ?? template?.settings.additional_maneuver_ids ?? [],
    },
    modal_table_id: draft.modalTable,
    damping_table_id: draft.dampingTable,
    prediction_id: draft.prediction,
    run_template_id: runTemplate?.method === method ? runTemplate.id : null,
  };
}

/**
 * One request for many maneuvers, from those for the first. Where the draft starts
 * from equation error and asks for it too, the others start from its result.
 */
export function batchRequest(
  draft: RunDraft,
  maneuvers: number[],
  template: RunRequest,
): BatchRequest {
  const { structure, structure_id, structure_version, settings } = template;
  const { modal_table_id, damping_table_id, prediction_id, run_template_id } = template;
  return {
    name: `${draft.methods.join(", ")} of ${maneuvers.length} maneuvers`,
    maneuver_ids: maneuvers,
    methods: draft.methods,
    structures: [{ structure, structure_id, structure_version }],
    settings,
    modal_table_id,
    damping_table_id,
    prediction_id,
    // A template is of one method.
    run_template_id: draft.methods.length === 1 ? run_template_id : null,
    from_equation_error:
      draft.start === "equation-error" && draft.methods.includes("EE") && draft.methods.length > 1,
    priority: 0,
  };
}

interface Beginning {
  maneuver: Maneuver;
  tables: ModalTable[];
  predictions: Prediction[];
  template?: Run;
  runTemplate?: RunTemplate;
  origin?: Origin;
  proposal?: RunProposal;
  methods?: RunDraft["methods"];
  /** Limits that were brushed [Hz]. */
  band?: [number, number];
}

/** The choices of an earlier run, or defaults that suit the maneuver. */
export function firstDraft(beginning: Beginning): RunDraft {
  const { band, runTemplate } = beginning;
  const begun = draftOfOrigin(beginning);
  const draft =
    runTemplate === undefined
      ? begun
      : { ...withSettings(begun, runTemplate.settings), methods: [runTemplate.method] };
  return band === undefined ? draft : { ...draft, band: [String(band[0]), String(band[1])] };
}

function draftOfOrigin(beginning: Beginning): RunDraft {
  const { maneuver, tables, predictions, template, origin, methods, proposal } = beginning;
  const modal = tables.find((one) => one.kind === "FEM");
  const excited = excitedInputs(maneuver);
  const sources = {
    modalTable: modal?.id ?? null,
    dampingTable: tables.find((one) => one.kind === "GVT")?.id ?? null,
    prediction: predictions[0]?.id ?? null,
  };
  if (template === undefined) {
    const draft: RunDraft = {
      ...EMPTY_DRAFT,
      axis: asAxis(maneuver.axis),
      ...sources,
      ...(methods && methods.length > 0 ? { methods } : {}),
    };
    const structure = origin?.structure ?? proposal?.structure;
    return structure === undefined ? draft : withStructure(draft, excited, structure);
  }
  const { structure, settings } = template;
  const draft: RunDraft = {
    ...withSettings(EMPTY_DRAFT, settings),
    axis: structure.axis,
    methods: [template.method],
    modalTable: template.modal_table_id ?? sources.modalTable,
    dampingTable: template.damping_table_id,
    prediction: template.prediction_id ?? sources.prediction,
  };
  return withStructure(draft, excited, structure);
}

/** Whether the draft still equals the stored structure that it started from. */
export function isUnchanged(draft: RunDraft, excited: string[], origin?: Origin): boolean {
  if (origin === undefined) return false;
  const same = (structure: Structure) =>
    JSON.stringify(structureOf(draft, excited)) ===
    JSON.stringify(structureOf(withStructure(draft, excited, structure), excited));
  return same(origin.structure) && draft.outOfBandModes !== "held";
}

function freeNames(structure: Structure, inputs: readonly string[]): string[] {
  return derivativeNames(structure.modes, inputs, structure.axis).filter(
    (name) => stateOf(structure, name) === "free",
  );
}

/** The draft with the settings of a run or of a template. */
export function withSettings(draft: RunDraft, settings: Run["settings"]): RunDraft {
  return {
    ...draft,
    start: STARTS.find((one) => one === settings.start) ?? "best",
    band: [String(settings.band_hz?.[0] ?? ""), String(settings.band_hz?.[1] ?? "")],
    noise: settings.noise === "full" ? "full" : "diagonal",
    priorSpread: settings.prior_spread,
    outOfBandModes: settings.out_of_band_modes,
    aerodynamics: settings.aerodynamics === "quasi-steady" ? "quasi-steady" : "shaped",
    maxIterations: settings.max_iterations,
  };
}

/** Settings in one line, as lists show them. */
export function settingsText(settings: Run["settings"]): string {
  const parts = [
    `start: ${settings.start.replaceAll("-", " ")}`,
    settings.band_hz == null ? "excited band" : `${settings.band_hz.join(" to ")} Hz`,
    `${settings.noise} noise`,
    `out-of-band modes ${settings.out_of_band_modes}`,
    settings.aerodynamics.replaceAll("-", " "),
  ];
  if (settings.prior_spread != null)
    parts.push(`priors at the prediction, ${settings.prior_spread}`);
  return `${parts.join("; ")}; at most ${settings.max_iterations} iterations`;
}

/** State of each page in its address. */
import {
  ADEQUACIES,
  DECISION_STATES,
  FREQUENCY_UNITS,
  METHODS,
  MODEL_AXES,
  STATES,
  UNIT_SYSTEMS,
  VERDICTS,
  type DecisionState,
  type Method,
  type ModelAxis,
  type RunState,
} from "./api/types";
import { flag, integer, integers, number, oneOf, text, words, type Search } from "./lib/urlState";

/** A page of the menu; `key` after `g` opens it, `at` matches the addresses that belong to it. */
export interface MenuPage {
  to:
    | "/"
    | "/excitation"
    | "/campaign"
    | "/conditions"
    | "/mini-gvt"
    | "/live"
    | "/import"
    | "/aircraft"
    | "/modal-data"
    | "/runs"
    | "/model-structures"
    | "/compare"
    | "/flutter"
    | "/global-model"
    | "/decisions"
    | "/jobs"
    | "/glossary";
  search?: Search;
  hash?: string;
  label: string;
  key: string;
  at?: RegExp;
}

/** Entries of the menu in the order of the work; an entry with several pages opens a dropdown. */
export const MENU: readonly { label: string; pages: readonly [MenuPage, ...MenuPage[]] }[] = [
  {
    label: "Plan",
    pages: [{ to: "/excitation", label: "Excitation", key: "e", at: /^\/excitation/ }],
  },
  {
    label: "Flights",
    pages: [
      { to: "/live", label: "Live", key: "w", at: /^\/live/ },
      { to: "/import", label: "Import", key: "i" },
      {
        to: "/campaign",
        label: "Campaign",
        key: "c",
        at: /^\/(campaign|maneuvers\/\d+|flights\/\d+)\/?$/,
      },
      { to: "/conditions", label: "Conditions", key: "u", at: /^\/conditions/ },
      {
        to: "/mini-gvt",
        label: "Mini-GVT",
        key: "v",
        at: /^\/(mini-gvt|flights\/\d+\/mini-gvt)/,
      },
    ],
  },
  {
    label: "Aircraft",
    pages: [
      { to: "/aircraft", label: "Aircraft", key: "a" },
      { to: "/modal-data", label: "Modal data", key: "o" },
      { to: "/aircraft", hash: "predictions", label: "Predictions", key: "n" },
    ],
  },
  {
    label: "Estimate",
    pages: [
      {
        to: "/runs",
        label: "Runs",
        key: "r",
        at: /^\/(runs|run-templates|batches|maneuvers\/\d+\/new-run)/,
      },
      { to: "/model-structures", label: "Model structures", key: "t", at: /^\/model-structures/ },
    ],
  },
  { label: "Compare", pages: [{ to: "/compare", label: "Compare", key: "m" }] },
  {
    label: "Predict",
    pages: [
      { to: "/flutter", label: "Flutter", key: "f" },
      { to: "/global-model", label: "Global model", key: "b", at: /^\/global-model/ },
    ],
  },
  {
    label: "Review",
    pages: [{ to: "/decisions", label: "Decisions", key: "d", at: /^\/decisions/ }],
  },
];

/** Pages at the right of the menu. */
export const SIDE_MENU: readonly MenuPage[] = [
  { to: "/jobs", label: "Jobs", key: "j", at: /^\/jobs/ },
  { to: "/glossary", label: "Glossary", key: "g" },
];

/** What the command palette and the keyboard open: every page, and parts that have a name. */
export const VIEWS: readonly MenuPage[] = [
  { to: "/", label: "Start", key: "s" },
  ...MENU.flatMap((entry) => entry.pages),
  ...SIDE_MENU,
  { to: "/campaign", search: { columns: "quality" }, label: "Data quality", key: "q" },
  { to: "/campaign", hash: "coverage", label: "Derivatives over the envelope", key: "k" },
  { to: "/model-structures", hash: "search", label: "Structure search", key: "h" },
  { to: "/compare", search: { tab: "validation" }, label: "Validation", key: "x" },
  { to: "/flutter", search: { tab: "closed-loop" }, label: "Closed loop", key: "l" },
];

/** Whether an address belongs to a page of the menu. */
export function isCurrent(page: MenuPage, pathname: string, hash: string): boolean {
  const isInside = page.at?.test(pathname) ?? pathname === page.to;
  return isInside && (pathname !== "/aircraft" || hash === (page.hash ?? ""));
}

/** In an address nothing is required. */
function view<T extends object>(read: (search: Search) => T): (search: Search) => Partial<T> {
  return read;
}

/**
 * Tab of an address. The name of a section passes, too: formerly each was a tab, and the route
 * opens the section in its place.
 */
function tabIn<Tab extends string>(
  value: unknown,
  tabs: Readonly<Record<Tab, readonly string[]>>,
): Tab | undefined {
  const sections = Object.values<readonly string[]>(tabs).flat();
  return oneOf(value, [...Object.keys(tabs), ...sections]) as Tab | undefined;
}

/** Display units and print format of figures, where they are not those that the user prefers. */
export const frameView = view((search) => ({
  width_mm: number(search.width_mm),
  height_mm: number(search.height_mm),
  font_pt: number(search.font_pt),
  units: oneOf(search.units, UNIT_SYSTEMS),
  frequency_unit: oneOf(search.frequency_unit, FREQUENCY_UNITS),
}));

/** Columns of the table of maneuvers, where not their runs. */
export const CAMPAIGN_COLUMNS = ["quality"] as const;

export const campaignView = view((search) => ({
  columns: oneOf(search.columns, CAMPAIGN_COLUMNS),
  verdict: oneOf(search.verdict, VERDICTS),
  /** Aircraft and coefficient of the coverage. */
  aircraft: integer(search.aircraft),
  coefficient: text(search.coefficient),
  search: text(search.search),
  flight: integer(search.flight),
  fta: integer(search.fta),
  min_ratio: number(search.min_ratio),
  max_ratio: number(search.max_ratio),
  /** Fuel limits in percent, as they are typed. */
  min_fuel: number(search.min_fuel),
  max_fuel: number(search.max_fuel),
  method: oneOf<Method>(search.method, METHODS),
  state: oneOf<RunState>(search.state, STATES),
  tag: text(search.tag),
  /** What was deleted, to restore it. */
  deleted: flag(search.deleted),
  sort: text(search.sort),
  selected: integers(search.selected),
}));
export type CampaignView = ReturnType<typeof campaignView>;

export const conditionView = view((search) => ({
  /** Derivative or sensor that is emphasised in all panels. */
  selected: text(search.selected),
  /** Input of the frequency responses. */
  input: text(search.input),
  /** Absolute values in panels of their own, instead of deviations. */
  absolute: flag(search.absolute),
  truth: flag(search.truth),
  /** Sheet that was frozen with a decision, in place of the current one. */
  frozen: integer(search.frozen),
}));
export type ConditionView = ReturnType<typeof conditionView>;

export const flightView = view((search) => ({
  channels: words(search.channels),
  /** Window of the recording [s], and the label of a maneuver cut there. */
  from: number(search.from),
  to: number(search.to),
  label: text(search.label),
  fta: integer(search.fta),
}));
export type FlightView = ReturnType<typeof flightView>;

export const liveView = view((search) => ({
  /** Run whose settings a new stream has. */
  run: integer(search.run),
}));

export const liveStreamView = view((search) => ({
  channels: words(search.channels),
  /** Of the frequency response. */
  output: text(search.output),
  input: text(search.input),
}));

export const runsView = view((search) => ({
  search: text(search.search),
  aircraft: integer(search.aircraft),
  flight: integer(search.flight),
  maneuver: integer(search.maneuver),
  fta: integer(search.fta),
  method: oneOf<Method>(search.method, METHODS),
  state: oneOf<RunState>(search.state, STATES),
  /** Result of the tests for remaining model error. */
  adequacy: oneOf(search.adequacy, ADEQUACIES),
  tag: text(search.tag),
  deleted: flag(search.deleted),
  derived: flag(search.derived),
  sort: text(search.sort),
  selected: integers(search.selected),
}));
export type RunsView = ReturnType<typeof runsView>;

export const BODE_PLANES = ["bode", "nichols", "nyquist", "loops"] as const;

/** Tabs of a maneuver with their sections. */
export const MANEUVER_TABS = {
  time: ["time"],
  quality: ["quality", "compatibility"],
  spectra: ["spectra", "inputs"],
  reconstruction: ["reconstruction"],
  bode: ["bode", "transfer-function", "output-only"],
  "grey-box": ["grey-box"],
  runs: ["runs"],
} as const;

export const maneuverView = view((search) => ({
  tab: tabIn(search.tab, MANEUVER_TABS),
  channels: words(search.channels),
  /** Window of the time histories [s]. */
  from: number(search.from),
  to: number(search.to),
  /** Window of everything over frequency [Hz]. */
  low: number(search.low),
  high: number(search.high),
  outputs: words(search.outputs),
  inputs: words(search.inputs),
  models: integers(search.models),
  /** Further maneuvers over this one in the Bode plot, or averaged with it. */
  overlay: integers(search.overlay),
  average: flag(search.average),
  /** Further maneuvers of the recorder, whose sensors are compared together with these. */
  compared: integers(search.compared),
  /** Models also with sensors blind to the structure. */
  rigid: flag(search.rigid),
  /** Responses from averaged windows instead of harmonics. */
  windowed: flag(search.windowed),
  plane: oneOf(search.plane, BODE_PLANES),
  /** Input, output and orders of the transfer function; usual orders where undefined. */
  from_input: text(search.from_input),
  to_output: text(search.to_output),
  zeros: integer(search.zeros),
  poles: integer(search.poles),
  integrators: integer(search.integrators),
  /** Without an equivalent delay. */
  no_delay: flag(search.no_delay),
  /** Job of the fit of a grey-box model. */
  fit: integer(search.fit),
  /** Scales of the Bode plot; logarithmic frequencies and dB where undefined. */
  frequency_scale: oneOf(search.frequency_scale, ["linear"] as const),
  magnitude_scale: oneOf(search.magnitude_scale, ["log", "linear"] as const),
  /** The whole spectrum behind the harmonics. */
  full: flag(search.full),
  domain: oneOf(search.domain, ["time", "frequency"] as const),
  /** Reconstructed quantities, and the modes of the reconstruction. */
  quantities: words(search.quantities),
  modes: integers(search.modes),
  /** Half that is reconstructed, of a maneuver that excites both axes. */
  axis: oneOf<ModelAxis>(search.axis, MODEL_AXES),
  /** Modes whose equation-error regressors are compared instead of channels. */
  regressors: integers(search.regressors),
  selected: integers(search.selected),
}));
export type ManeuverView = ReturnType<typeof maneuverView>;

export const newRunView = view((search) => ({
  methods: words(search.methods)?.flatMap((word) => oneOf<Method>(word, METHODS) ?? []),
  /** Run whose choices are the starting point. */
  template_run: integer(search.template_run),
  /** Template whose settings are the starting point. */
  run_template: integer(search.run_template),
  /** Further maneuvers that get the same run. */
  additional_maneuvers: integers(search.additional_maneuvers),
  /** One run over all of them instead of one each. */
  joint: flag(search.joint),
  /** Band to fit [Hz]. */
  low: number(search.low),
  high: number(search.high),
  /** Stored model structure to start from, and its version where not the newest. */
  structure: integer(search.structure),
  version: integer(search.version),
  /** Axis of the model, of a maneuver that excites both. */
  axis: oneOf<ModelAxis>(search.axis, MODEL_AXES),
}));

/** Tabs of a run with their sections. */
export const RUN_TABS = {
  result: ["parameters", "poles", "correlation"],
  fit: ["fit", "residuals", "time"],
  checks: ["tests", "sensors", "aerodynamics", "posterior"],
  record: ["write-back", "provenance", "iterations"],
} as const;

export const runView = view((search) => ({
  tab: tabIn(search.tab, RUN_TABS),
  block: text(search.block),
  output: text(search.output),
  sort: text(search.sort),
  /** Window of everything over frequency [Hz]. */
  low: number(search.low),
  high: number(search.high),
  /** Outputs of the check in time, and the maneuver that it is made with. */
  outputs: words(search.outputs),
  against: integer(search.against),
  /** Window of that check [s]. */
  from: number(search.from),
  to: number(search.to),
}));
export type RunView = ReturnType<typeof runView>;

export const PARTITIONS = ["folds", "frequencies", "periods"] as const;

/** Tabs of a comparison with their sections. */
export const COMPARE_TABS = {
  derivatives: ["derivatives", "agreement", "setup"],
  trends: ["trends", "amplitudes"],
  responses: ["responses", "poles"],
  validation: ["time", "validation"],
} as const;
export const AGAINST = ["dynamic_pressure", "airspeed_ratio", "fuel", "fta"] as const;

export const compareView = view((search) => ({
  tab: tabIn(search.tab, COMPARE_TABS),
  runs: integers(search.runs),
  predictions: integers(search.predictions),
  coefficient: text(search.coefficient),
  /** Only derivatives on which the runs differ. */
  differences: flag(search.differences),
  maneuver: integer(search.maneuver),
  /** Source that the others are held against. */
  baseline: text(search.baseline),
  /** Whether the runs are of several amplitudes, whose models are compared. */
  amplitudes: flag(search.amplitudes),
  /** Derivative of the forest plot and of the trend. */
  derivative: text(search.derivative),
  against: oneOf(search.against, AGAINST),
  degree: integer(search.degree),
  /** Output of the frequency responses, and their window [Hz]. */
  output: text(search.output),
  low: number(search.low),
  high: number(search.high),
  /** Window from the start of the maneuvers [s], all of them in one plot, and every pair of
   *  run and maneuver. */
  from: number(search.from),
  to: number(search.to),
  arrangement: oneOf(search.arrangement, ["overlay"] as const),
  every: flag(search.every),
  /** Maneuvers that the runs predict, theirs by default, and the prediction that is shown. */
  maneuvers: integers(search.maneuvers),
  predicted_by: integer(search.predicted_by),
  predicted: integer(search.predicted),
  /** Data that are held out from refits of that run. */
  partition: oneOf(search.partition, PARTITIONS),
  folds: integer(search.folds),
}));
export type CompareView = ReturnType<typeof compareView>;

/** Treatment of unmodelled modes, where they are not included with their prediction. */
const UNMODELLED_MODES = ["residualized"] as const;

export const ALONG = ["dynamic_pressure", "fuel"] as const;
export const VARIATIONS = ["linear", "global-model"] as const;

export const PREDICTION_AXES = ["longitudinal", "lateral"] as const;
export type PredictionAxis = (typeof PREDICTION_AXES)[number];

/** Tabs of the flutter page, of one section each. */
export const FLUTTER_TABS = { flutter: ["flutter"], "closed-loop": ["closed-loop"] } as const;

export const flutterView = view((search) => ({
  tab: tabIn(search.tab, FLUTTER_TABS),
  runs: integers(search.runs),
  /** Fuel in percent, altitude [m] and next airspeed [m/s], where not the fastest point's. */
  fuel: number(search.fuel),
  altitude: number(search.altitude),
  next: number(search.next),
  unmodelled_modes: oneOf(search.unmodelled_modes, UNMODELLED_MODES),
  /** What roots are followed along, where not airspeed. */
  along: oneOf(search.along, ALONG),
  /** Derivatives over the envelope, where not constant. */
  variation: oneOf(search.variation, VARIATIONS),
  /** Prediction whose flutter is shown, beside that of the runs or alone. */
  prediction: integer(search.prediction),
  /** Axis of a prediction alone, where not its first. */
  axis: oneOf(search.axis, PREDICTION_AXES),
  controller: integer(search.controller),
}));
export type FlutterView = ReturnType<typeof flutterView>;

export const MODAL_TABS = [
  "fuel",
  "shapes",
  "mac",
  "sensors",
  "order",
  "gvt",
  "flutter",
  "files",
] as const;
export const SYMMETRIES = ["symmetric", "antisymmetric", "all"] as const;

export const modalDataView = view((search) => ({
  tab: oneOf(search.tab, MODAL_TABS),
  aircraft: integer(search.aircraft),
  table: integer(search.table),
  mode: integer(search.mode),
  /** Fuel in percent. */
  fuel: number(search.fuel),
  /** The second source, mode and fuel of whatever is compared. */
  other: integer(search.other),
  other_mode: integer(search.other_mode),
  other_fuel: number(search.other_fuel),
  side_by_side: flag(search.side_by_side),
  still: flag(search.still),
  /** Largest displacement in percent of the span. */
  scale: number(search.scale),
  symmetry: oneOf(search.symmetry, SYMMETRIES),
  up_to: number(search.up_to),
  airspeed: number(search.airspeed),
  altitude: number(search.altitude),
  derivatives: words(search.derivatives),
  output: text(search.output),
  surface: text(search.surface),
  upload: text(search.upload),
  /** Job of an orthogonality over a mass matrix. */
  orthogonality: integer(search.orthogonality),
  /** Measured responses, the band in which modes are looked for, the highest order. */
  responses: integer(search.responses),
  from_hz: number(search.from_hz),
  to_hz: number(search.to_hz),
  order: integer(search.order),
  /** Poles of the stabilisation diagram that are selected by hand. */
  poles: integers(search.poles),
  /** Degrees of freedom of the response that is drawn, such as 12+z. */
  response_dof: text(search.response_dof),
  reference_dof: text(search.reference_dof),
  /** Flutter summary, the place of its analysis, damping g, and the prediction beside it. */
  summary: integer(search.summary),
  analysis: integer(search.analysis),
  g: number(search.g),
  prediction: integer(search.prediction),
}));
export type ModalDataView = ReturnType<typeof modalDataView>;

export const VARIABLES = [
  "dynamic_pressure_pa",
  "fuel_fraction",
  "airspeed_m_s",
  "airspeed_ratio",
  "alpha_rad",
] as const;

export const globalModelView = view((search) => ({
  runs: integers(search.runs),
  /** Variables of the envelope, where not dynamic pressure and fuel. */
  variables: words(search.variables)?.flatMap((word) => oneOf(word, VARIABLES) ?? []),
  prediction: integer(search.prediction),
  /** Slice: derivative, variable, and SI values at which the others are held. */
  derivative: text(search.derivative),
  along: oneOf(search.along, VARIABLES),
  condition: words(search.condition)?.flatMap((word) => number(word) ?? []),
}));
export const globalModelVersionView = view((search) => ({
  /** Version that is compared; the one before by default. */
  base: integer(search.base),
}));

export type GlobalModelView = ReturnType<typeof globalModelView>;

export const DESIGN_SOURCES = ["table", "own", "flown"] as const;

export const excitationView = view((search) => ({ from: oneOf(search.from, DESIGN_SOURCES) }));
export type ExcitationView = ReturnType<typeof excitationView>;

export const DESIGN_TABS = [
  "excitation",
  "accuracy",
  "amplitudes",
  "optimal",
  "classic",
  "preflight-simulation",
] as const;

export const OBJECTIVES = ["flutter", "derivatives", "damping", "structures"] as const;

export const designView = view((search) => ({
  tab: oneOf(search.tab, DESIGN_TABS),
  /** Amplitude: 0 low, 1 medium, 2 high. */
  level: integer(search.level),
  /** Actuator: natural frequency [rad/s], deflection [deg] and rate [deg/s] limits. */
  actuator: number(search.actuator),
  /** Airspeed of the target modes [m/s]. */
  airspeed: number(search.airspeed),
  position: number(search.position),
  rate: number(search.rate),
  /** Output-error run whose derivatives the design would be flown for. */
  run: integer(search.run),
  /** Limits of the amplitude optimisation: deflection [deg] and load factor [g]. */
  allowed: number(search.allowed),
  /** Limit of the optimal design on the rate of surfaces [deg/s], and its objective. */
  fastest: number(search.fastest),
  objective: oneOf(search.objective, OBJECTIVES),
  derivatives: text(search.derivatives),
  mode: text(search.mode),
  other: integer(search.other),
  spread: number(search.spread),
  after: flag(search.after),
  load: number(search.load),
  /** Window of everything over frequency [Hz]. */
  low: number(search.low),
  /** Whose modes the band is compared with. */
  aircraft: integer(search.aircraft),
  high: number(search.high),
}));
export type DesignView = ReturnType<typeof designView>;

export const glossaryView = view((search) => ({ search: text(search.search) }));

export const jobsView = view((search) => ({ state: oneOf<RunState>(search.state, STATES) }));

export const LATTICE_QUANTITIES = [
  "layout",
  "pressure",
  "mode",
  "aspect-ratio",
  "resolution",
] as const;

export const aircraftView = view((search) => ({
  id: integer(search.id),
  /** Prediction whose boxes are shown, by which quantity, and its variable or mode. */
  prediction: integer(search.prediction),
  quantity: oneOf(search.quantity, LATTICE_QUANTITIES),
  column: text(search.column),
}));
export type AircraftView = ReturnType<typeof aircraftView>;

export const batchView = view((search) => ({ state: oneOf<RunState>(search.state, STATES) }));

export const IMPORT_FORMS = ["table", "toml"] as const;

export const importView = view((search) => ({
  upload: text(search.upload),
  form: oneOf(search.form, IMPORT_FORMS),
  channels: words(search.channels),
}));

export const SEARCH_ALGORITHMS = ["stepwise", "orthogonal functions"] as const;
export const INITIAL_TERMS = ["all", "equation error"] as const;

export const modelStructuresView = view((search) => ({
  aircraft: integer(search.aircraft),
  /** The search that is shown; without one, what the next would be. */
  id: integer(search.id),
  /** Coefficient, or method, whose path and terms are shown. */
  group: text(search.group),
  maneuvers: integers(search.maneuvers),
  unseen: integers(search.unseen),
  method: oneOf<Method>(search.method, METHODS),
  modes: integers(search.modes),
  algorithm: oneOf(search.algorithm, SEARCH_ALGORITHMS),
  initial_terms: oneOf(search.initial_terms, INITIAL_TERMS),
  f_in: number(search.f_in),
  f_out: number(search.f_out),
}));
export type ModelStructuresView = ReturnType<typeof modelStructuresView>;

const CELL_NUMBERS = ["all", "none"] as const;

export const modelStructureView = view((search) => ({
  /** Older version that is read; the newest can be changed. */
  version: integer(search.version),
  /** Structure and version that it is compared with. */
  against: integer(search.against),
  against_version: integer(search.against_version),
  /** Run whose estimates stand in the cells; the structure's last one by default. */
  run: integer(search.run),
  numbers: oneOf(search.numbers, CELL_NUMBERS),
}));
export type ModelStructureView = ReturnType<typeof modelStructureView>;

export const decisionsView = view((search) => ({
  aircraft: integer(search.aircraft),
  state: oneOf<DecisionState>(search.state, DECISION_STATES),
}));

export const newDecisionView = view((search) => ({
  structure: integer(search.structure),
  version: integer(search.version),
  /** Structure and version that the proposal changes. */
  changes: integer(search.changes),
  changes_version: integer(search.changes_version),
  /** Version of a global model, in place of a structure. */
  global_model: integer(search.global_model),
  runs: integers(search.runs),
}));

export const decisionView = view((search) => ({
  /** Derivative that is looked at and commented on. */
  derivative: text(search.derivative),
  /** The proposal is being revised. */
  revise: flag(search.revise),
}));
export type DecisionView = ReturnType<typeof decisionView>;

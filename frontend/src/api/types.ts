/** Short names of the API types. */
import type { Readable } from "openapi-typescript-helpers";
import type { components } from "./schema.gen";

type Schemas = components["schemas"];
/**
 * Responses are complete: members with a default are present, and stored
 * records have an id. The OpenAPI description does not state this, since it shares
 * schemas between requests and responses.
 */
export type Full<T> = T extends readonly (infer Item)[]
  ? Full<Item>[]
  : T extends object
    ? { [Key in keyof T]-?: Key extends "id" ? NonNullable<T[Key]> : Full<T[Key]> }
    : T;

type Received<Name extends keyof Schemas> = Full<Readable<Schemas[Name]>>;

export type Session = Received<"SessionState">;
export type Role = Session["roles"][number]["role"];
export type SessionItem = Received<"SessionItem">;
export type Token = Received<"TokenItem">;
export type TokenRequest = Schemas["TokenRequest"];
export const UNIT_SYSTEMS = ["metric", "us", "si"] as const;
export const FREQUENCY_UNITS = ["Hz", "rad/s"] as const;
/** Display units of figures, tables and reports. */
export interface DisplayUnits {
  units: (typeof UNIT_SYSTEMS)[number];
  frequency_unit: (typeof FREQUENCY_UNITS)[number];
}
export type RunTemplate = Received<"RunTemplateItem">;
export type ManeuverItem = Received<"ManeuverItem">;
export type Maneuver = Received<"ManeuverDetail">;
export type Channel = Received<"Channel">;
export type ManeuverQuality = Received<"ManeuverQuality">;
export type ChannelQuality = Received<"ChannelQuality">;
export type SurfaceQuality = Received<"SurfaceQuality">;
export type QualityItem = Received<"QualityItem">;
export type ConditioningStep = Received<"ConditioningStep">;
export type ManeuverProposal = Received<"ManeuverProposal">;
export type FlightChannel = Received<"FlightChannel">;
export type CutRequest = Schemas["CutRequest"];
export type StepRequest = Schemas["StepRequest"];
export type Verdict = ManeuverQuality["verdict"];
export type GroundTest = Received<"GroundTest">;
export type Flutter = Received<"Flutter">;
export type PredictedFlutter = Received<"PredictedFlutter">;
export type Compatibility = Received<"CompatibilityReport">;
export type SensorFault = Compatibility["faults"][number];
export type SensorEstimate = Compatibility["sensors"][number];
export type OutputOnlyResult = Received<"OutputOnlyResult">;
export type GreyBoxFit = Received<"GreyBoxFit">;
export type GreyBoxItem = Received<"GreyBoxItem">;
export type GreyBoxRequest = Schemas["GreyBoxRequest"];
export type TransferFunction = Received<"TransferFunction">;
export type PosteriorCheck = Received<"PosteriorCheck">;
export type AmplitudeComparison = Received<"AmplitudeComparison">;
export type RepeatedLevels = Received<"RepeatedLevels">;
export type AerodynamicsComparison = Received<"AerodynamicsComparison">;
export type DerivedRun = Received<"DerivedRun">;
export type StructureSearch = Received<"StructureSearch">;
export type SearchCandidate = Received<"SearchCandidate">;
export type TermGroup = Received<"TermGroup">;
export type SearchRequest = Schemas["SearchRequest"];
export type Flight = Received<"Flight">;
export type Dashboard = Received<"CampaignDashboard">;
export type OpenWarnings = Received<"OpenWarnings">;
export type Aircraft = Received<"Aircraft">;
export type ModalTable = Received<"ModalTable">;
export type ModalTableDetail = Received<"ModalTableDetail">;
export type Prediction = Received<"DerivativePrediction">;
export type ModelStructure = Received<"ModelStructure">;
export type StructureRequest = Schemas["ModelStructureRequest"];
export type StructureEditRequest = Schemas["StructureEditRequest"];
export type ConditionItem = Received<"ConditionItem">;
export type ConditionSheet = Received<"ConditionSheet">;
export type DecisionItem = Received<"DecisionItem">;
export type Decision = Received<"DecisionDetail">;
export type DecisionEvent = Received<"DecisionEvent">;
export type Proposal = Received<"ModelProposal">;
export type Note = Received<"Note">;
export type NoteRequest = Schemas["NoteRequest"];
export type VoteEvidence = Received<"VoteEvidence">;
export type ProposalRequest = Schemas["ProposalRequest"];
export type StaleProposal = Received<"StaleProposal">;
export type ReviewedGlobalModel = Received<"ReviewedGlobalModel">;
export type WriteBackItem = Received<"WriteBack">;
export type WriteBackProposal = Received<"WriteBackProposal">;
export type GlobalModelDetail = Received<"GlobalModelDetail">;
export type VersionDifferences = Received<"VersionDifferences">;
export type GlobalModelVersionRequest = Schemas["GlobalModelVersionRequest"];
export type Baseline = Received<"Baseline">;
export type RunProposal = Received<"RunProposal">;
export type RulesHistory = Received<"RulesHistory">;
export type RulesRequest = Schemas["RulesRequest"];
export type Notifications = Received<"Notifications">;
export type DecisionState = Schemas["DecisionState"];
export type Vote = Schemas["Vote"];
export type Quantity = Schemas["LimitedQuantity"];
export type FreezeRequest = Schemas["FreezeRequest"];
export type StaleStructure = Received<"StaleStructure">;
export type StructureVersion = Received<"StructureVersion">;
export type Run = Received<"Run">;
export type RunItem = Received<"RunItem">;
export type Facets = Received<"Facets">;
export type Choice = Received<"Choice">;
export type RunRequest = Schemas["RunRequest"];
export type BatchRequest = Schemas["BatchRequest"];
export type Batch = Received<"BatchProgress">;
export type QueueStatus = Received<"QueueStatus">;
export type JobEvent = Received<"JobEvent">;
export type Design = Received<"ExcitationDesign">;
export type DesignChecks = Received<"DesignChecks">;
export type ExpectedError = Received<"ExpectedError">;
export type ExpectedMode = Received<"ExpectedMode">;
export type TargetMode = Received<"TargetMode">;
export type RowTargets = Received<"RowTargets">;
export type ExpectedErrors = Received<"ExpectedErrors">;
export type ExpectedSummary = Received<"ExpectedSummary">;
export type ComparedInput = Received<"ComparedInput">;
export type InputComparison = Received<"InputComparison">;
export type ClosedLoopStability = Received<"ClosedLoopStability">;
export type GlobalModelSummary = Received<"GlobalModelSummary">;
export type CrossPredictionMatrix = Received<"CrossPredictionMatrix">;
export type CrossValidationSummary = Received<"CrossValidationSummary">;
export type ValidatedOutput = Received<"ValidatedOutput">;
export type MarginRow = Received<"MarginRow">;
export type ThrustTable = Received<"ThrustTable">;
export type ThrustRequest = Schemas["ThrustRequest"];
export type Controller = Received<"Controller">;
export type SimulationResult = Received<"SimulationResult">;
export type SimulatedDerivative = Received<"SimulatedDerivative">;
export type OptimalDesign = Received<"OptimalDesign">;
export type OptimisedAmplitudes = Received<"OptimisedAmplitudes">;
export type OptimisedPeak = Received<"OptimisedPeak">;
export type OptimisedError = Received<"OptimisedError">;
export type DesignRequest = Schemas["DesignRequest"];
export type PreflightSimulationRequest = Schemas["PreflightSimulationRequest"];
export type ComputePredictionRequest = Schemas["ComputePredictionRequest"];
export type SaveGlobalPredictionRequest = Schemas["SaveGlobalPredictionRequest"];
export type CatalogueRow = Received<"CatalogueRow">;
export type UploadDetail = Received<"UploadDetail">;
export type CheckedMapping = Received<"Checked">;
export type UnitWarning = Received<"UnitWarning">;
export type Guess = Received<"Guess">;
export type Parameter = Received<"RunParameter">;
export type Fit = Received<"Fit">;
export type ModelAdequacy = Received<"ModelAdequacy">;
export type AdequacyState = ModelAdequacy["state"];
export type Pole = Received<"Pole">;
export type Job = Received<"JobItem">;
export type Comparison = Received<"Comparison">;
export type LiveStream = Received<"LiveStream">;
export type LiveStreamDetail = Received<"StreamDetail">;
export type LiveSnapshot = Received<"LiveSnapshot">;
export type LiveState = Received<"LiveState">;
export type LiveEstimate = Received<"LiveEstimate">;
export type LiveMode = Received<"LiveMode">;
export type LiveAlarm = Received<"LiveAlarm">;
export type LiveTestPoint = Received<"LiveTestPoint">;
export type Acknowledgement = Received<"Acknowledgement">;
export type StreamChannel = Received<"StreamChannel">;
export type StreamRequest = Schemas["StreamRequest"];
export type Receiver = Received<"ReceiverItem">;
export type Reception = Received<"Reception">;
export type StripColumns = Received<"StripChart">;
export type ComparisonRow = Received<"Row">;
export type Source = Received<"ComparedSource">;
export type Pair = Received<"Pair">;
export type DerivativeTrend = Received<"DerivativeTrend">;

export type SavedViewRequest = Schemas["SavedViewRequest"];
export type ModeShape = Received<"ModeShape">;
export type ModeAtFuel = Received<"ModeAtFuel">;
export type Correlation = Received<"Correlation">;
export type PairedMode = Received<"PairedMode">;
export type Observability = Received<"Observability">;
export type ModelOrder = Received<"ModelOrder">;
export type StructureFound = Received<"ModalFiles">;
export type MeasuredResponses = Received<"MeasuredResponses">;
export type FoundModes = Received<"FoundModes">;
export type ResponsesRequest = Schemas["ResponsesRequest"];
export type EstimatedResponsesRequest = Schemas["EstimatedResponsesRequest"];
export type FlutterSummary = Received<"FlutterSummary">;
export type SummaryRoots = Received<"SummaryRoots">;
export type ModalDataRequest = Schemas["ModalDataRequest"];
export type MassRequest = Schemas["MassRequest"];
export type OrthogonalityRequest = Schemas["OrthogonalityRequest"];
export type Orthogonality = Schemas["Orthogonality"];
export type GlossaryEntry = Received<"GlossaryEntry">;

export type Method = Run["method"];
export type RunState = Run["state"];

/** Axis of a model; a combined maneuver has a longitudinal and a lateral one. */
export type ModelAxis = "longitudinal" | "lateral" | "longitudinal-airspeed";
export const MODEL_AXES: readonly ModelAxis[] = [
  "longitudinal",
  "lateral",
  "longitudinal-airspeed",
];
export const METHODS: readonly Method[] = ["OE", "FRE", "EE"];
export const STATES: readonly RunState[] = [
  "queued",
  "running",
  "succeeded",
  "failed",
  "cancelled",
];

export const METHOD_NAMES: Record<Method, string> = {
  OE: "Output error",
  FRE: "Frequency response error",
  EE: "Equation error",
};

/** Name of a method; those of installed packages are their own names. */
export const methodName = (method: string): string =>
  new Map<string, string>(Object.entries(METHOD_NAMES)).get(method) ?? method;

/** Whether the data sets of a run are coefficients, as of equation error, and not outputs. */
export const fitsCoefficients = ({ method, blocks }: Pick<Run, "method" | "blocks">): boolean =>
  method === "EE" ||
  (!METHODS.some((one) => one === method) &&
    blocks.every(({ name, outputs }) => outputs.length === 1 && name.endsWith(outputs[0] ?? "")));

/** A run that will not change any more. */
export const isOver = (state: RunState): boolean => state !== "queued" && state !== "running";

/** A Plotly figure as the server sends it. */
export interface FigureSpec {
  data: Record<string, unknown>[];
  layout: Record<string, unknown>;
}

/** What can be done to many maneuvers or runs at once. */
export type Action = Schemas["Action"];
export type ManyOf = "maneuvers" | "runs";

/** Verdicts on the data of maneuvers; missing where they are not assessed. */
export const VERDICTS = ["bad", "questionable", "unchecked", "good", "missing"] as const;

export interface ManeuverFilters {
  search?: string;
  flight_id?: number;
  fta?: number;
  min_airspeed_ratio?: number;
  max_airspeed_ratio?: number;
  min_fuel?: number;
  max_fuel?: number;
  verdict?: (typeof VERDICTS)[number];
  method?: Method;
  state?: RunState;
  tag?: string;
  deleted?: boolean;
}

export interface RunFilters {
  aircraft_id?: number;
  flight_id?: number;
  maneuver_id?: number;
  structure_id?: number;
  fta?: number;
  method?: Method;
  state?: RunState;
  adequacy?: AdequacyState;
  tag?: string;
  search?: string;
  deleted?: boolean;
  derived?: boolean;
  derived_from_run_id?: number;
}

export const ADEQUACIES: readonly AdequacyState[] = ["consistent", "suspect", "not tested"];
export const DECISION_STATES: readonly DecisionState[] = [
  "open",
  "changes-requested",
  "approved",
  "rejected",
  "withdrawn",
  "superseded",
];

/** A decision that can still be voted on. */
export const isOpen = (state: DecisionState): boolean =>
  state === "open" || state === "changes-requested";

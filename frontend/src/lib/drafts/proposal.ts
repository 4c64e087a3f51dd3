/** A proposal while it is written, and what differs between two. */
import { axisNames } from "../derivatives";
import type { Convert } from "../text/format";
import type { Limits, TypedLimits } from "../limits";
import { limitsText, readLimits, typed } from "../limits";

export interface Reference {
  id: number;
  version: number;
}

export interface Comparison {
  run_ids: number[];
  prediction_ids: number[];
  coefficient: string | null;
}

/** A stored proposal. */
export interface StoredProposal {
  title: string;
  structure: Reference | null;
  global_model_id: number | null;
  changes: Reference | null;
  limits: Limits;
  reasoning: string;
  run_ids: number[];
  comparisons: Comparison[];
  figure_ids: number[];
}

/** A figure that is to be frozen when the proposal is sent. */
interface FigureRequest {
  kind: string;
  query: string;
  title: string;
}

export interface ProposalDraft {
  title: string;
  structure: Reference | null;
  /** Version of a global model, in place of a structure. */
  globalModel: number | null;
  changes: Reference | null;
  limits: TypedLimits;
  reasoning: string;
  runs: number[];
  comparisons: Comparison[];
  /** Frozen already. */
  figures: number[];
  requests: FigureRequest[];
}

export const EMPTY_PROPOSAL: ProposalDraft = {
  title: "",
  structure: null,
  globalModel: null,
  changes: null,
  limits: {},
  reasoning: "",
  runs: [],
  comparisons: [],
  figures: [],
  requests: [],
};

export function draftOf(proposal: StoredProposal): ProposalDraft {
  return {
    title: proposal.title,
    structure: proposal.structure,
    globalModel: proposal.global_model_id,
    changes: proposal.changes,
    limits: typed(proposal.limits),
    reasoning: proposal.reasoning,
    // The server adds the runs of a global model.
    runs: proposal.global_model_id === null ? proposal.run_ids : [],
    comparisons: proposal.comparisons,
    figures: proposal.figure_ids,
    requests: [],
  };
}

/** The proposal to send once the requested figures are frozen, or its fault. */
export function proposalOf(draft: ProposalDraft, frozen: number[]) {
  const read = readLimits(draft.limits);
  if ("fault" in read) return read;
  if (draft.structure === null && draft.globalModel === null)
    return { fault: "Select the proposed structure." };
  if (draft.title.trim() === "") return { fault: "Give the decision a title." };
  if (draft.reasoning.trim() === "") return { fault: "Give the reasoning." };
  return {
    proposal: {
      title: draft.title,
      structure: draft.structure,
      global_model_id: draft.globalModel,
      changes: draft.changes,
      limits: read.limits,
      reasoning: draft.reasoning,
      run_ids: draft.runs,
      comparisons: draft.comparisons,
      figure_ids: [...draft.figures, ...frozen],
    },
  };
}

/** Figures of runs that can be frozen. */
export function figuresOf(runs: readonly { id: number; method: string }[]): FigureRequest[] {
  const each = runs.flatMap(({ id, method }) =>
    [
      ["fit", "Fit"],
      ["residual", "Residuals"],
      ["parameter-correlation", "Correlation of the estimates"],
      ["poles", "Poles"],
    ].map(([kind = "", title = ""]) => ({
      kind,
      query: `run_id=${id}`,
      title: `${title} of ${method} run ${id}`,
    })),
  );
  const ids = runs.map((one) => one.id).join(",");
  const all = axisNames("longitudinal").coefficients.map((coefficient) => ({
    kind: "derivatives",
    query: `run_ids=${ids}&coefficient=${coefficient}`,
    title: `Derivatives of ${coefficient}, runs ${ids}`,
  }));
  return ids === "" ? [] : [...all, ...each];
}

const PROPOSAL_PARTS = [
  "title",
  "structure",
  "global_model_id",
  "changes",
  "limits",
  "reasoning",
  "run_ids",
  "comparisons",
  "figure_ids",
] as const;
type ProposalPart = (typeof PROPOSAL_PARTS)[number];

const PART_NAMES: Record<ProposalPart, string> = {
  title: "Title",
  structure: "Structure",
  global_model_id: "Global model",
  changes: "Changes",
  limits: "Conditions",
  reasoning: "Reasoning",
  run_ids: "Runs",
  comparisons: "Comparisons",
  figure_ids: "Figures",
};

function partText(proposal: StoredProposal, part: ProposalPart, convert?: Convert): string {
  const reference = (one: Reference | null) =>
    one === null ? "none" : `structure ${one.id}, version ${one.version}`;
  switch (part) {
    case "structure":
    case "changes":
      return reference(proposal[part]);
    case "global_model_id":
      return proposal.global_model_id === null ? "none" : String(proposal.global_model_id);
    case "limits":
      return limitsText(proposal.limits, convert);
    case "title":
    case "reasoning":
      return proposal[part];
    case "comparisons":
      return proposal.comparisons.map((one) => `runs ${one.run_ids.join(", ")}`).join("; ");
    default:
      return proposal[part].join(", ");
  }
}

export function proposalDifferences(
  before: StoredProposal,
  after: StoredProposal,
  convert?: Convert,
) {
  return PROPOSAL_PARTS.map((part) => ({
    part,
    what: PART_NAMES[part],
    before: partText(before, part, convert),
    after: partText(after, part, convert),
  })).filter((one) => one.before !== one.after);
}

/** My parts merged into theirs; where both changed one, mine is used and listed. */
export function mergedProposal(base: StoredProposal, theirs: StoredProposal, mine: StoredProposal) {
  const own = proposalDifferences(base, mine);
  const other = new Map(proposalDifferences(base, theirs).map((one) => [one.part, one.after]));
  const clashes = own
    .filter((one) => other.has(one.part) && other.get(one.part) !== one.after)
    .map((one) => one.what);
  const taken = Object.fromEntries(own.map(({ part }) => [part, mine[part]]));
  return { proposal: { ...theirs, ...taken }, clashes };
}

/** A proposal while it is written, and what differs between two. */
import type { Limits, TypedLimits } from "./limits";
import { limitsText, readLimits, typed } from "./limits";

export interface Reference {
  id: number;
  version: number;
}

export interface Comparison {
  run_ids: number[];
  prediction_ids: number[];
  coefficient: string | null;
}

/** A proposal as it is kept. */
export interface KeptProposal {
  title: string;
  structure: Reference;
  changes: Reference | null;
  limits: Limits;
  reasoning: string;
  run_ids: number[];
  comparisons: Comparison[];
  figure_ids: number[];
}

/** A figure that is to be frozen when the proposal is sent. */
export interface FigureWish {
  kind: string;
  query: string;
  title: string;
}

export interface ProposalDraft {
  title: string;
  structure: Reference | null;
  changes: Reference | null;
  limits: TypedLimits;
  reasoning: string;
  runs: number[];
  comparisons: Comparison[];
  /** Frozen already. */
  figures: number[];
  wishes: FigureWish[];
}

export const EMPTY_PROPOSAL: ProposalDraft = {
  title: "",
  structure: null,
  changes: null,
  limits: {},
  reasoning: "",
  runs: [],
  comparisons: [],
  figures: [],
  wishes: [],
};

export function draftOf(proposal: KeptProposal): ProposalDraft {
  return {
    title: proposal.title,
    structure: proposal.structure,
    changes: proposal.changes,
    limits: typed(proposal.limits),
    reasoning: proposal.reasoning,
    runs: proposal.run_ids,
    comparisons: proposal.comparisons,
    figures: proposal.figure_ids,
    wishes: [],
  };
}

/** What is sent, once the wished figures are frozen; or why it cannot be sent. */
export function proposalOf(draft: ProposalDraft, frozen: number[]) {
  const read = readLimits(draft.limits);
  if ("fault" in read) return read;
  if (draft.structure === null) return { fault: "Choose the structure that is proposed." };
  if (draft.title.trim() === "") return { fault: "Give the decision a title." };
  if (draft.reasoning.trim() === "") return { fault: "Say why." };
  return {
    proposal: {
      title: draft.title,
      structure: draft.structure,
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
export function figuresOf(runs: readonly { id: number; method: string }[]): FigureWish[] {
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
  const all = ["CZ", "Cm"].map((coefficient) => ({
    kind: "derivatives",
    query: `run_ids=${ids}&coefficient=${coefficient}`,
    title: `Derivatives of ${coefficient}, runs ${ids}`,
  }));
  return ids === "" ? [] : [...all, ...each];
}

export const PROPOSAL_PARTS = [
  "title",
  "structure",
  "changes",
  "limits",
  "reasoning",
  "run_ids",
  "comparisons",
  "figure_ids",
] as const;
export type ProposalPart = (typeof PROPOSAL_PARTS)[number];

const SAID: Record<ProposalPart, string> = {
  title: "Title",
  structure: "Structure",
  changes: "Changes",
  limits: "Conditions",
  reasoning: "Reasoning",
  run_ids: "Runs",
  comparisons: "Comparisons",
  figure_ids: "Figures",
};

function said(proposal: KeptProposal, part: ProposalPart): string {
  const reference = (one: Reference | null) =>
    one === null ? "none" : `structure ${one.id}, version ${one.version}`;
  switch (part) {
    case "structure":
    case "changes":
      return reference(proposal[part]);
    case "limits":
      return limitsText(proposal.limits);
    case "title":
    case "reasoning":
      return proposal[part];
    case "comparisons":
      return proposal.comparisons.map((one) => `runs ${one.run_ids.join(", ")}`).join("; ");
    default:
      return proposal[part].join(", ");
  }
}

export function proposalDifferences(before: KeptProposal, after: KeptProposal) {
  return PROPOSAL_PARTS.map((part) => ({
    part,
    what: SAID[part],
    before: said(before, part),
    after: said(after, part),
  })).filter((one) => one.before !== one.after);
}

/** My parts on top of theirs; where both changed one otherwise, mine stands and is named. */
export function mergedProposal(base: KeptProposal, theirs: KeptProposal, mine: KeptProposal) {
  const own = proposalDifferences(base, mine);
  const other = new Map(proposalDifferences(base, theirs).map((one) => [one.part, one.after]));
  const clashes = own
    .filter((one) => other.has(one.part) && other.get(one.part) !== one.after)
    .map((one) => one.what);
  const taken = Object.fromEntries(own.map(({ part }) => [part, mine[part]]));
  return { proposal: { ...theirs, ...taken }, clashes };
}

import { describe, expect, it } from "vitest";
import {
  draftOf,
  EMPTY_PROPOSAL,
  mergedProposal,
  proposalDifferences,
  proposalOf,
  type StoredProposal,
} from "./proposal";

const STORED: StoredProposal = {
  title: "SP at low speed",
  structure: { id: 1, version: 1 },
  global_model_id: null,
  changes: null,
  limits: { fuel_fraction: [0, 0.5] },
  reasoning: "F below 4",
  run_ids: [1],
  comparisons: [],
  figure_ids: [],
};

describe("a proposal", () => {
  it("is unchanged by its draft, with new figures added", () => {
    expect(proposalOf(draftOf(STORED), [5])).toEqual({ proposal: { ...STORED, figure_ids: [5] } });
  });

  it("reports missing parts", () => {
    expect(proposalOf(EMPTY_PROPOSAL, [])).toHaveProperty("fault");
    expect(proposalOf({ ...draftOf(STORED), reasoning: " " }, [])).toEqual({
      fault: "Give the reasoning.",
    });
  });

  it("merges two edits", () => {
    const theirs = { ...STORED, title: "SP", structure: { id: 1, version: 2 } };
    const mine = { ...STORED, title: "SP + SW1B", run_ids: [1, 2] };
    const { proposal, clashes } = mergedProposal(STORED, theirs, mine);
    expect(clashes).toEqual(["Title"]);
    expect(proposal).toEqual({ ...mine, structure: { id: 1, version: 2 } });
    expect(proposalDifferences(STORED, theirs).map((one) => one.what)).toEqual([
      "Title",
      "Structure",
    ]);
  });
});

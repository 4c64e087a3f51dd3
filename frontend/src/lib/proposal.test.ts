import { describe, expect, it } from "vitest";
import {
  draftOf,
  EMPTY_PROPOSAL,
  mergedProposal,
  proposalDifferences,
  proposalOf,
  type KeptProposal,
} from "./proposal";

const KEPT: KeptProposal = {
  title: "SP at low speed",
  structure: { id: 1, version: 1 },
  changes: null,
  limits: { fuel_fraction: [0, 0.5] },
  reasoning: "F below 4",
  run_ids: [1],
  comparisons: [],
  figure_ids: [],
};

describe("a proposal", () => {
  it("comes back from its draft as it was kept, with new figures", () => {
    expect(proposalOf(draftOf(KEPT), [5])).toEqual({ proposal: { ...KEPT, figure_ids: [5] } });
  });

  it("says what it lacks", () => {
    expect(proposalOf(EMPTY_PROPOSAL, [])).toHaveProperty("fault");
    expect(proposalOf({ ...draftOf(KEPT), reasoning: " " }, [])).toEqual({ fault: "Say why." });
  });

  it("puts my changes on top of a colleague's", () => {
    const theirs = { ...KEPT, title: "SP", structure: { id: 1, version: 2 } };
    const mine = { ...KEPT, title: "SP + SW1B", run_ids: [1, 2] };
    const { proposal, clashes } = mergedProposal(KEPT, theirs, mine);
    expect(clashes).toEqual(["Title"]);
    expect(proposal).toEqual({ ...mine, structure: { id: 1, version: 2 } });
    expect(proposalDifferences(KEPT, theirs).map((one) => one.what)).toEqual([
      "Title",
      "Structure",
    ]);
  });
});

import { describe, expect, it } from "vitest";
import { derivativeNames } from "./derivatives";
import {
  counts,
  differences,
  EMPTY_STATES,
  heldAt,
  merged,
  resized,
  stateOf,
  stateText,
  withState,
  type Structure,
} from "./structure";

const SURFACES = ["bfs", "wf1s"];
const ALL = derivativeNames([7], SURFACES, "longitudinal");
const PLAIN: Structure = {
  ...EMPTY_STATES,
  modes: [7],
  inputs: [],
  outputs: [],
  free_delays: false,
  extra_parameters: [],
  axis: "longitudinal",
  delays: {},
  instruments: {},
};
const edited = (...edits: [string, "free" | "fixed" | "absent"][]): Structure =>
  edits.reduce<Structure>(
    (one, [name, state]) => ({ ...one, ...withState(one, ALL, [name], state) }),
    PLAIN,
  );

describe("states of derivatives", () => {
  it("frees all by default", () => {
    expect(counts(PLAIN, ALL)).toEqual({ free: ALL.length, fixed: 0, absent: 0 });
  });

  it("gives every derivative one state, and takes it back without a trace", () => {
    const held = withState(PLAIN, ALL, ["Cm_q"], "fixed", { source: "prediction", id: 2 });
    expect(stateText(held, "Cm_q")).toBe("fixed to prediction 2");
    expect(held.free).toBeNull();
    const gone = withState(held, ALL, ["Cm_q"], "absent");
    expect(gone).toEqual({ ...EMPTY_STATES, absent: ["Cm_q"] });
    expect(withState(gone, ALL, ["Cm_q"], "free")).toEqual(EMPTY_STATES);
  });

  it("lists the free ones only where something is held at the start", () => {
    const held = withState(PLAIN, ALL, ["Cm_q"], "fixed");
    expect(held.free).toHaveLength(ALL.length - 1);
    expect(heldAt(held, "Cm_q")).toEqual({ source: "start" });
    const also = withState(held, ALL, ["CZ_q"], "absent");
    expect(also.free).not.toContain("CZ_q");
    expect(stateOf(withState(also, ALL, ["CZ_q"], "free"), "CZ_q")).toBe("free");
  });

  it("frees the derivatives of a new mode only", () => {
    const wider = resized(
      edited(["Cm_q", "fixed"], ["CZ_q", "absent"]),
      { modes: [7, 9] },
      SURFACES,
    );
    expect(stateOf(wider, "Cm_q")).toBe("fixed");
    expect(stateOf(wider, "CZ_q")).toBe("absent");
    expect(stateOf(wider, "CQ9_eta7")).toBe("free");
    expect(resized(wider, { modes: [7] }, SURFACES)).toEqual(
      edited(["Cm_q", "fixed"], ["CZ_q", "absent"]),
    );
  });
});

describe("differences and merging", () => {
  it("names what differs", () => {
    const found = differences(PLAIN, { ...edited(["Cm_q", "absent"]), outputs: ["q"] }, SURFACES);
    expect(found).toEqual([
      { what: "Cm_q", before: "free", after: "absent" },
      { what: "outputs", before: "all suitable", after: "q" },
    ]);
  });

  it("puts my changes on top of theirs", () => {
    const theirs = { ...edited(["Cm_q", "absent"]), outputs: ["q"] };
    const mine = { ...edited(["CZ_q", "absent"]), free_delays: true };
    const { structure, clashes } = merged(PLAIN, theirs, mine, SURFACES);
    expect(clashes).toEqual([]);
    expect(structure.absent).toEqual(["CZ_q", "Cm_q"]);
    expect([structure.outputs, structure.free_delays]).toEqual([["q"], true]);
  });

  it("names what both changed otherwise", () => {
    const { structure, clashes } = merged(
      PLAIN,
      edited(["Cm_q", "absent"]),
      edited(["Cm_q", "fixed"]),
      SURFACES,
    );
    expect(clashes).toEqual(["Cm_q"]);
    expect(stateOf(structure, "Cm_q")).toBe("fixed");
  });

  it("retains a mode added in their version", () => {
    const theirs = resized(PLAIN, { modes: [7, 9] }, SURFACES);
    const { structure } = merged(PLAIN, theirs, edited(["Cm_q", "absent"]), SURFACES);
    expect(structure.modes).toEqual([7, 9]);
    expect(stateOf(structure, "Cm_q")).toBe("absent");
    expect(stateOf(structure, "CQ9_q")).toBe("free");
  });
});

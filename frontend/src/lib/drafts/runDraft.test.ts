import { describe, expect, it } from "vitest";
import { derivativeNames } from "../derivatives";
import {
  bandOf,
  draftFault,
  EMPTY_DRAFT,
  statesOf,
  structureOf,
  withStates,
  withStructure,
} from "./runDraft";
import { EMPTY_STATES } from "../structure";

const draft = { ...EMPTY_DRAFT, modes: [7] };

describe("a new run", () => {
  it("frees every derivative by default", () => {
    expect(statesOf(draft, ["bfs"])).toEqual(EMPTY_STATES);
  });

  it("names derivatives as the API does", () => {
    expect(derivativeNames([7], ["bfs"], "longitudinal")).toEqual([
      "CZ_alpha",
      "CZ_q",
      "CZ_eta7",
      "CZ_etadot7",
      "CZ_bfs",
      "Cm_alpha",
      "Cm_q",
      "Cm_eta7",
      "Cm_etadot7",
      "Cm_bfs",
      "CQ7_alpha",
      "CQ7_q",
      "CQ7_eta7",
      "CQ7_etadot7",
      "CQ7_bfs",
    ]);
  });

  it("frees the derivatives of a mode added later", () => {
    const held = withStates(draft, ["bfs"], { ...EMPTY_STATES, free: ["Cm_alpha", "Cm_q"] });
    const { free } = statesOf({ ...held, modes: [7, 9] }, ["bfs"]);
    expect(free).toContain("CQ9_eta9");
    expect(free).toContain("Cm_alpha");
    expect(free).not.toContain("CZ_alpha");
  });

  it("takes a structure over and gives it back", () => {
    const structure = {
      ...EMPTY_STATES,
      free: ["Cm_alpha"],
      absent: ["CZ_q"],
      fixed: { Cm_q: -2 },
      fixed_to: { CZ_alpha: { source: "prediction" as const, id: 1 } },
      modes: [7],
      inputs: [],
      outputs: ["q"],
      free_delays: false,
      extra_parameters: ["delay_q"],
      axis: "longitudinal",
      delays: { q: 0.01 },
      instruments: { q: null },
    };
    expect(structureOf(withStructure(draft, ["bfs"], structure), ["bfs"])).toEqual(structure);
  });

  it("takes a band with both limits, in order", () => {
    expect(bandOf(draft)).toEqual({ band: null });
    expect(bandOf({ ...draft, band: ["0,5", "6"] })).toEqual({ band: [0.5, 6] });
    expect(bandOf({ ...draft, band: ["1", ""] })).toHaveProperty("fault");
    expect(bandOf({ ...draft, band: ["6", "0.5"] })).toHaveProperty("fault");
  });

  it("cannot start without a selected prediction", () => {
    expect(draftFault(draft)).toBeNull();
    expect(draftFault({ ...draft, start: "prediction" })).toMatch(/prediction/);
    expect(draftFault({ ...draft, methods: [] })).toMatch(/method/);
  });
});

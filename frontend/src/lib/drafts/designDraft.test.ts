import { describe, expect, it } from "vitest";
import { EMPTY_DRAFT, inputsOf, requestOf } from "./designDraft";

describe("a custom design", () => {
  it("moves surfaces together, against each other, or each by itself", () => {
    const names = (axis: "symmetric" | "antisymmetric" | "independent") =>
      inputsOf({ ...EMPTY_DRAFT, surfaces: "bf, wf1", axis }).map((own) => own.name);
    expect(names("symmetric")).toEqual(["bfs", "wf1s"]);
    expect(names("antisymmetric")).toEqual(["bfa", "wf1a"]);
    expect(names("independent")).toEqual(["bfl", "bfr", "wf1l", "wf1r"]);
  });

  it("does not add an input twice, and goes on with the last band", () => {
    const [first] = inputsOf({ ...EMPTY_DRAFT, surfaces: "bf" });
    if (first === undefined) throw new Error("no input");
    const next = inputsOf({
      ...EMPTY_DRAFT,
      surfaces: "bf, wf1",
      inputs: [{ ...first, high: 5 }],
    });
    expect(next.map((own) => [own.name, own.high])).toEqual([["wf1s", 5]]);
  });

  it("becomes a request in radians, or a message", () => {
    const draft = { ...EMPTY_DRAFT, name: "own", inputs: inputsOf(EMPTY_DRAFT).slice(0, 1) };
    const first = draft.inputs[0];
    if (first === undefined) throw new Error("no input");
    first.targets = "3, 10.5";
    first.spectrum = "0.3:1, 12:0.01";
    const request = requestOf(draft);
    if (typeof request === "string") throw new Error(request);
    expect(request.peaks[1]).toBeCloseTo(0.0349, 4);
    expect(request.bands[0]).toMatchObject({
      targets_hz: [3, 10.5],
      spectrum: [
        [0.3, 1],
        [12, 0.01],
      ],
    });
    first.spectrum = "flat";
    expect(requestOf(draft)).toContain("bfs");
  });
});

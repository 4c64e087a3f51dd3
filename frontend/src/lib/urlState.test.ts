import { describe, expect, it } from "vitest";
import { campaignView, compareView, maneuverView } from "../views";
import { parseSearch, stringifySearch } from "./urlState";

const through = (view: object) => parseSearch(stringifySearch({ ...view }));

describe("the view in the address", () => {
  it("survives being written and read", () => {
    const view = compareView({ runs: [3, 1], predictions: [2], differences: true });
    expect(stringifySearch({ ...view })).toBe("?runs=3,1&predictions=2&differences=true");
    expect(compareView(through(view))).toEqual(view);
  });

  it("encodes any text", () => {
    const view = campaignView({ search: "F17 & 50 % / µ?" });
    expect(campaignView(through(view)).search).toBe("F17 & 50 % / µ?");
  });

  it("leaves out what is not set", () => {
    expect(stringifySearch({ ...campaignView({}) })).toBe("");
  });

  it("drops what cannot be read instead of failing", () => {
    const view = maneuverView({ tab: "nonsense", from: "abc", to: "4.5", models: "1,x,2" });
    expect(view).toMatchObject({ tab: undefined, from: undefined, to: 4.5, models: [1, 2] });
  });

  it("reads text that looks like a number as text", () => {
    expect(campaignView(parseSearch("?search=506")).search).toBe("506");
  });
});

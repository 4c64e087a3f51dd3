import { describe, expect, it } from "vitest";
import {
  confirmPath,
  guessedKeys,
  matchRules,
  readKey,
  readList,
  readQuantity,
  removeTable,
  setKey,
  setManeuver,
  setToml,
  writeQuantity,
} from "./mappingText";

const TEXT = `[aircraft]
name = "X-1"

[flight]
number = 7  # the first

[[channels]]
column = "bf"
unit = "deg"
guessed = ["unit", "role"]
role = "input"

[[channels]]
column = "q"
role = "output"

[channels.unit]
q = "deg/s"
`;

describe("quantities of a mapping", () => {
  it("are read and written as numbers or fields", () => {
    const text = '[maneuver.condition]\nairspeed = { field = "tas", unit = "kt" }\nfuel = 0.5\n';
    expect(readQuantity(text, "maneuver.condition", "airspeed")).toEqual({
      given: "tas",
      unit: "kt",
    });
    expect(readQuantity(text, "maneuver.condition", "fuel")).toEqual({ given: "0.5", unit: "1" });
    const changed = setToml(text, "maneuver.condition", 0, "airspeed", writeQuantity("120", "kt"));
    expect(changed).toContain('airspeed = { value = 120, unit = "kt" }');
  });

  it("belong to a maneuver that can be taken out and added", () => {
    const flight = setManeuver(
      '[maneuver]\nlabel = "a"\n\n[maneuver.condition]\nfuel = 1\n',
      false,
    );
    expect(flight).not.toContain("maneuver");
    expect(setManeuver(flight, true)).toContain("[maneuver.condition]");
  });
});

describe("patterns", () => {
  it("match columns and names; an incomplete one matches nothing", () => {
    const rules = [{ column: "AZ_W01", name: "az_w01" }, { column: "Q" }];
    expect(matchRules(rules, "^az_w\\d+$")).toEqual([0]);
    expect(matchRules(rules, "(")).toBeUndefined();
  });
});

describe("edits of a mapping", () => {
  it("change one key of one table and leave the rest", () => {
    expect(setKey(TEXT, "channels", 0, "unit", "rad")).toBe(
      TEXT.replace('unit = "deg"\nguessed = ["unit", "role"]', 'unit = "rad"\nguessed = ["role"]'),
    );
    expect(setKey(TEXT, "flight", 0, "number", 8)).toContain("number = 8\n");
  });

  it("add a key at the end of its table", () => {
    expect(setKey(TEXT, "channels", 1, "name", "q_egi")).toContain(
      'role = "output"\nname = "q_egi"\n\n[channels.unit]',
    );
    expect(setKey(TEXT, "channels", 0, "confirmed", ["too-large"])).toContain(
      'role = "input"\nconfirmed = ["too-large"]\n',
    );
  });

  it("take a key or a table out", () => {
    expect(setKey(TEXT, "channels", 0, "unit", undefined)).not.toContain('"unit"');
    const less = removeTable(TEXT, "channels", 0);
    expect(less).not.toContain('"bf"');
    expect(less).toContain('column = "q"');
  });

  it("settle what was guessed", () => {
    expect([0, 1, 2].map((nth) => guessedKeys(TEXT, "channels", nth))).toEqual([
      ["unit", "role"],
      [],
      [],
    ]);
    const edited = setKey(TEXT, "channels", 0, "unit", "deg");
    expect(guessedKeys(edited, "channels", 0)).toEqual(["role"]);
    expect(confirmPath(edited, "channels[1].role")).not.toContain("guessed");
    const nested = '[maneuver.condition]\nfuel = 1\nguessed = ["fuel"]\n';
    expect(confirmPath(nested, "maneuver.condition.fuel")).not.toContain("guessed");
  });

  it("add a table that is not there", () => {
    expect(setKey("", "aircraft", 0, "name", "X-1")).toContain('[aircraft]\nname = "X-1"');
  });

  it("read a value that stands on one line", () => {
    expect(readKey(TEXT, "aircraft", "name")).toBe("X-1");
    expect(readKey(TEXT, "flight", "number")).toBe("7");
    expect(readKey(TEXT, "maneuver", "label")).toBeUndefined();
  });

  it("sets a key before the first table", () => {
    const repaired = setKey(TEXT, "", 0, "repair", ["single-nan", "midnight"]);
    expect(repaired).toBe(`repair = ["single-nan","midnight"]\n${TEXT}`);
    expect(readList(repaired, "", 0, "repair")).toEqual(["single-nan", "midnight"]);
    expect(setKey(repaired, "", 0, "repair", undefined)).toBe(TEXT);
    expect(readList(TEXT, "", 0, "repair")).toEqual([]);
  });
});

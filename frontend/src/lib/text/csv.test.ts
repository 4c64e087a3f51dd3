import { expect, it } from "vitest";
import { csv } from "./csv";

it("writes cells that a spreadsheet neither runs nor splits", () => {
  expect(
    csv([
      ["=1+1", 'a "b", c'],
      [-0.5, null],
    ]),
  ).toBe('\'=1+1,"a ""b"", c"\r\n-0.5,\r\n');
});

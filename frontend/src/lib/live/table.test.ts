import { expect, test } from "vitest";
import { parseTable } from "./table";

test("rows of a form are the table of an option", () => {
  expect(parseTable(" q = ATTITUDE.pitchspeed\n\naz=-HIGHRES_IMU.zacc \n")).toEqual({
    q: "ATTITUDE.pitchspeed",
    az: "-HIGHRES_IMU.zacc",
  });
  // Without a field, so that the server names the channel.
  expect(parseTable("q")).toEqual({ q: "" });
  expect(parseTable("")).toEqual({});
});

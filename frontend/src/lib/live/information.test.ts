import { expect, test } from "vitest";
import { adviseDuration } from "./information";

test("a maneuver may stop early when every derivative has the expected information", () => {
  expect(adviseDuration([])).toBeUndefined();
  expect(adviseDuration([1.2, 0.46, 1])).toBe(
    "Not yet enough: 2 of 3 derivatives with the expected information, the least has 46 %",
  );
  expect(adviseDuration([1, 1.4])).toBe(
    "Enough to stop early: 2 of 2 derivatives with the expected information",
  );
});

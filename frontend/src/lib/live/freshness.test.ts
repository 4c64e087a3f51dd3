import { expect, it } from "vitest";
import { assessFreshness } from "./freshness";

it.each([
  [null, "waiting"],
  [9_500, "current"],
  [9_000, "late"],
  [7_001, "late"],
  [7_000, "lost"],
  [0, "lost"],
] as const)("assesses data received at %s ms, at 10 s, as %s", (received_ms, expected) => {
  expect(assessFreshness({ received_ms, hasEnded: false }, 10_000)).toBe(expected);
});

it("does not call a stream late that has ended", () => {
  expect(assessFreshness({ received_ms: 0, hasEnded: true }, 10_000)).toBe("ended");
});

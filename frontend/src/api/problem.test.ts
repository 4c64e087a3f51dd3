import { expect, it } from "vitest";
import { address } from "./client";
import { ApiProblem, asProblem, problemFrom } from "./problem";

it("reads problem details with their context", () => {
  const problem = problemFrom(
    { type: "about:blank", title: "Bad", status: 422, detail: "No.", code: "bad", row: 12 },
    422,
  );
  expect(problem).toMatchObject({ title: "Bad", detail: "No.", code: "bad", status: 422 });
  expect(problem.context).toEqual({ row: 12 });
});

it("explains a response that is not a problem", () => {
  expect(problemFrom("<html>", 502).detail).toContain("502");
  expect(asProblem(new Error("x is undefined"))).toBeInstanceOf(ApiProblem);
});

it("writes addresses that can be read", () => {
  expect(address("figures/bode", { outputs: ["q", "az"], run: undefined, name: "a&b" })).toBe(
    "/api/v1/figures/bode?outputs=q,az&name=a%26b",
  );
});

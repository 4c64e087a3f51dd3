import { expect, it } from "vitest";
import { fitsCoefficients, methodName, type Run } from "./types";

const block = (name: string, ...outputs: string[]) => ({ name, outputs, quality: [] });
const run = (method: string, ...blocks: unknown[]) =>
  ({ method, blocks }) as unknown as Pick<Run, "method" | "blocks">;

it("knows what the method of a package has fitted", () => {
  expect(fitsCoefficients(run("least-squares", block("CZ", "CZ"), block("Cm", "Cm")))).toBe(true);
  expect(fitsCoefficients(run("maximum-entropy", block("doublet", "alpha", "q")))).toBe(false);
  expect(fitsCoefficients(run("OE", block("doublet of q", "q")))).toBe(false);
  expect(methodName("least-squares")).toBe("least-squares");
});

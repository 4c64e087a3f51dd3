import { expect, test } from "vitest";
import { jobAddress } from "./jobAddress";

const job = (request: Record<string, unknown>, result: Record<string, unknown> | null = null) => ({
  id: 12,
  request,
  result,
});

test("values of the request stand in path, search and hash", () => {
  const page = "/runs/{run_id}?tab=checks&runs={runs}&fuel={fuel:percent}&no_delay={delay:not}#p";
  const request = { run_id: 3, runs: [3, 1], fuel: 0.55, delay: false };
  expect(jobAddress(page, job(request))).toBe(
    "/runs/3?tab=checks&runs=3,1&fuel=55&no_delay=true#p",
  );
});

test("search parameters without value are left out", () => {
  const page = "/flutter?runs={flutter.run_ids}&fuel={flutter.fuel:percent}&no_delay={delay:not}";
  expect(jobAddress(page, job({ flutter: { run_ids: [2], fuel: null }, delay: true }))).toBe(
    "/flutter?runs=2",
  );
});

test("a job leads nowhere without what its address names", () => {
  expect(jobAddress("/excitation/{result.design_id}", job({}))).toBeNull();
  expect(jobAddress("", job({}))).toBeNull();
  expect(jobAddress("/excitation/{result.design_id}", job({}, { design_id: 4 }))).toBe(
    "/excitation/4",
  );
});

test("the first of several maneuvers is shown, and names are encoded", () => {
  expect(jobAddress("/maneuvers/{ids}?of={name}#c", job({ ids: [7, 8], name: "a b&c" }))).toBe(
    "/maneuvers/7?of=a%20b%26c#c",
  );
  expect(jobAddress("/api/v1/backups/{id}", job({}))).toBe("/api/v1/backups/12");
});

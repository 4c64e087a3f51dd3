import { screen, within } from "@testing-library/react";
import userEvent from "@testing-library/user-event";
import { afterEach, expect, it, vi } from "vitest";
import { show } from "../test/render";
import { ExcitationPage } from "./ExcitationPage";

const ROW = {
  number: 524,
  numbers: [524, 525, 526],
  axis: "symmetric",
  periods: 4,
  surfaces: 5,
  throttles: 1,
  harmonics_per_input: 66,
  throttle_harmonics: 2,
  targets: "PH SP LE HE",
  inputs: ["bfs", "throttle"],
};

const respond = (content: unknown) =>
  new Response(JSON.stringify(content), { headers: { "Content-Type": "application/json" } });

afterEach(() => {
  vi.unstubAllGlobals();
});

it("designs a row of the catalogue for its duration, in radians", async () => {
  const posted: unknown[] = [];
  vi.stubGlobal("fetch", async (request: Request) => {
    if (request.method === "POST") {
      posted.push(await request.json());
      return respond({ id: "t0123456789abcdef", kind: "design", state: "running", fraction: 0.2 });
    }
    return respond({ items: request.url.endsWith("/catalogue") ? [ROW] : [], next: null });
  });
  await show(<ExcitationPage />);
  expect(await screen.findByText("No designs yet")).toBeInTheDocument();
  const table = within(await screen.findByTestId("catalogue-table"));
  expect(table.getByText("524–526")).toBeInTheDocument();
  expect(table.getByText("1 × 2")).toBeInTheDocument();
  await userEvent.click(table.getByRole("button", { name: "Design FTA 524" }));
  await vi.waitFor(() => {
    expect(posted).toHaveLength(1);
  });
  expect(posted[0]).toMatchObject({ fta: 524, duration_s: 96, rate_hz: 100 });
  const { peaks } = posted[0] as { peaks: number[] };
  expect(peaks[1]).toBeCloseTo(0.0349, 4);
});

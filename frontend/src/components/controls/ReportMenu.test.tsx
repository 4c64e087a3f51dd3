import { screen } from "@testing-library/react";
import userEvent from "@testing-library/user-event";
import { afterEach, expect, it, vi } from "vitest";
import { storeUnits } from "../../api/units";
import { show } from "../../test/render";
import { ReportMenu } from "./ReportMenu";

const JOB = {
  id: 21,
  kind: "report",
  state: "running",
  progress: { fraction: 0.2, message: "Printing" },
};

afterEach(() => {
  vi.unstubAllGlobals();
  localStorage.clear();
});

it("prints a PDF by a job, which can be cancelled, and links to the file", async () => {
  const posted: string[] = [];
  let state = "running";
  vi.stubGlobal("fetch", (request: Request) => {
    if (request.method === "POST") posted.push(new URL(request.url).pathname);
    if (request.url.endsWith("/cancel")) state = "cancelled";
    if (request.url.endsWith("/retry")) state = "succeeded";
    const finished_at = state === "running" ? null : `2026-11-24T00:00:0${posted.length}Z`;
    return Promise.resolve(
      new Response(JSON.stringify({ ...JOB, state, finished_at, typical_s: { report: 6.4 } }), {
        headers: { "Content-Type": "application/json" },
      }),
    );
  });
  storeUnits({ units: "us", frequency_unit: "Hz" });
  await show(<ReportMenu of="run/3" />);
  await userEvent.click(screen.getByTestId("report"));
  const page = await screen.findByTestId("report-html");
  expect(page).toHaveAttribute("href", "/api/v1/reports/run/3?units=us");
  await userEvent.click(screen.getByTestId("report-pdf"));
  expect(await screen.findByText(/Printing, usually 6 s/)).toBeInTheDocument();
  await userEvent.click(await screen.findByRole("button", { name: "Cancel" }));
  expect(await screen.findByText("Cancelled; nothing was stored.")).toBeInTheDocument();
  expect(screen.queryByTestId("open-report")).not.toBeInTheDocument();
  await userEvent.click(screen.getByRole("button", { name: "Retry" }));
  const file = await screen.findByTestId("open-report");
  expect(file).toHaveAttribute("href", "/api/v1/reports/files/21");
  expect(posted[0]).toBe("/api/v1/reports/run/3");
});

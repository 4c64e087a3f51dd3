import { useRouterState } from "@tanstack/react-router";
import { screen } from "@testing-library/react";
import { afterEach, expect, it, vi } from "vitest";
import { show } from "../../test/render";
import { CampaignProgress, useFirstSheet } from "./CampaignProgress";

const STARTING = { name: "demonstration", state: "starting", text: "11%, 4 of 38 maneuvers." };

afterEach(() => {
  vi.unstubAllGlobals();
});

function Start() {
  useFirstSheet();
  const path = useRouterState({ select: (state) => state.location.pathname });
  return (
    <>
      <CampaignProgress />
      <p data-testid="path">{path}</p>
    </>
  );
}

it("opens the first sheet of a demonstration that is still filled", async () => {
  vi.stubGlobal("fetch", (request: Request | string) => {
    if (request === "/") {
      return Promise.resolve({ redirected: true, url: "http://localhost/conditions/4" });
    }
    const health = { version: "0.1.0", parts: [STARTING] };
    return Promise.resolve(
      new Response(JSON.stringify(health), { headers: { "Content-Type": "application/json" } }),
    );
  });
  await show(<Start />);
  expect(await screen.findByText("/conditions/4")).toBeInTheDocument();
  expect(screen.getByTestId("campaign-progress")).toHaveTextContent("4 of 38 maneuvers");
});

import { screen } from "@testing-library/react";
import userEvent from "@testing-library/user-event";
import { afterEach, expect, it, vi } from "vitest";
import { setAccountName } from "../../api/analyst";
import type { Decision, Session } from "../../api/types";
import { show } from "../../test/render";
import { DecisionComposer } from "./DecisionComposer";

const DECISION = {
  id: 1,
  aircraft_id: 1,
  state: "open",
  authors: ["Bea"],
  rules: { own_allowed: false },
} as unknown as Decision;

async function open(mode: Session["mode"], roles: Session["roles"], warnings: string[] = []) {
  const name = mode === "personal" ? null : "Ann";
  vi.spyOn(globalThis, "fetch").mockImplementation(() =>
    Promise.resolve(
      new Response(JSON.stringify({ mode, name, roles }), {
        headers: { "Content-Type": "application/json" },
      }),
    ),
  );
  setAccountName(name);
  await show(
    <DecisionComposer
      decision={DECISION}
      revision={1}
      consequence="supersedes decision 2"
      warnings={warnings}
    />,
  );
}

afterEach(() => {
  vi.restoreAllMocks();
  setAccountName(null);
  localStorage.clear();
});

it("offers votes to reviewers of the campaign, in the name of the account", async () => {
  await open("team", [
    { aircraft_id: 1, role: "reviewer" },
    { aircraft_id: 2, role: "viewer" },
  ]);
  expect(await screen.findByText("As Ann.")).toBeInTheDocument();
  expect(screen.getByTestId("vote-approve")).toBeInTheDocument();
});

it("offers comments and no votes to analysts", async () => {
  await open("team", [
    { aircraft_id: 1, role: "analyst" },
    { aircraft_id: 2, role: "reviewer" },
  ]);
  expect(await screen.findByText(/Votes need the role reviewer/)).toBeInTheDocument();
  expect(screen.getByTestId("comment")).toBeInTheDocument();
  expect(screen.queryByTestId("vote-approve")).not.toBeInTheDocument();
});

it("offers nothing to viewers", async () => {
  await open("team", [{ aircraft_id: null, role: "viewer" }]);
  expect(await screen.findByText(/Comments need the role analyst/)).toBeInTheDocument();
  expect(screen.queryByTestId("comment")).not.toBeInTheDocument();
});

it("offers all to whoever has set a name, without accounts", async () => {
  localStorage.setItem("flexsid.analyst", "Cid");
  await open("personal", []);
  expect(await screen.findByText("As Cid, unverified.")).toBeInTheDocument();
  expect(screen.getByTestId("vote-approve")).toBeInTheDocument();
});

it("states the consequence of approval in the button, and offers no approval without it", async () => {
  localStorage.setItem("flexsid.analyst", "Cid");
  await open("personal", []);
  await userEvent.type(await screen.findByTestId("comment-text"), "looked at");
  expect(screen.getByTestId("vote-approve")).toHaveTextContent("Approve: supersedes decision 2");
  expect(screen.getByTestId("vote-approve")).toBeEnabled();
  await show(
    <DecisionComposer decision={DECISION} revision={1} consequence={undefined} warnings={[]} />,
  );
  for (const button of screen.getAllByText("Approve"))
    expect(button.closest("button")).toBeDisabled();
});

it("takes an approval despite open warnings only with a reason of its own", async () => {
  localStorage.setItem("flexsid.analyst", "Cid");
  await open("personal", [], ["The runs cover one airspeed."]);
  await userEvent.type(await screen.findByTestId("comment-text"), "ok");
  expect(screen.getByTestId("vote-approve")).toBeDisabled();
  expect(screen.getByTestId("vote-reject")).toBeEnabled();
  await userEvent.type(screen.getByTestId("despite-text"), "flown next at this airspeed only");
  expect(screen.getByTestId("vote-approve")).toBeEnabled();
});

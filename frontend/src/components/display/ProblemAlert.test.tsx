import { screen } from "@testing-library/react";
import userEvent from "@testing-library/user-event";
import { expect, it, vi } from "vitest";
import { ApiProblem } from "../../api/problem";
import { show } from "../../test/render";
import { ProblemAlert } from "./ProblemAlert";

it("shows the problem, its location and a retry button", async () => {
  const retry = vi.fn();
  const problem = new ApiProblem("Unreadable file", "Text in a number.", "unreadable-file", 422, {
    row: 17,
    column: "az_egi",
  });
  await show(<ProblemAlert error={problem} onRetry={retry} />);
  const alert = screen.getByRole("alert");
  expect(alert).toHaveTextContent("Unreadable file");
  expect(alert).toHaveTextContent("row 17, column az_egi");
  expect(alert).toHaveTextContent("unreadable-file");
  await userEvent.click(screen.getByRole("button", { name: "Retry" }));
  expect(retry).toHaveBeenCalledOnce();
});

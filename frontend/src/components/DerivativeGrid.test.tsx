import { screen } from "@testing-library/react";
import userEvent from "@testing-library/user-event";
import { useState } from "react";
import { expect, it } from "vitest";
import { show } from "../test/render";
import { DerivativeGrid } from "./DerivativeGrid";

function Grid() {
  const [free, setFree] = useState<string[] | null>(null);
  return <DerivativeGrid modes={[7]} inputs={["bfs"]} free={free} onChange={setFree} />;
}

const cell = (name: string) => screen.getByRole("checkbox", { name });

it("is one tab stop; arrows move and Space toggles", async () => {
  await show(<Grid />);
  const user = userEvent.setup();
  cell("CZ_alpha").focus();
  await user.keyboard("{ArrowRight}{ArrowDown}");
  expect(cell("Cm_q")).toHaveFocus();
  await user.keyboard(" ");
  expect(cell("Cm_q")).not.toBeChecked();
  expect(screen.getByTestId("free-count")).toHaveTextContent("14 of 15 free");
  expect(screen.getAllByRole("checkbox").filter((one) => one.tabIndex === 0)).toEqual([
    cell("Cm_q"),
  ]);
});

it("stops at the edges", async () => {
  await show(<Grid />);
  const user = userEvent.setup();
  cell("CZ_alpha").focus();
  await user.keyboard("{ArrowLeft}{ArrowUp}");
  expect(cell("CZ_alpha")).toHaveFocus();
});

it("toggles a whole row or column by its name", async () => {
  await show(<Grid />);
  const user = userEvent.setup();
  await user.click(screen.getByTitle("Toggle all of CZ"));
  expect(screen.getByTestId("free-count")).toHaveTextContent("10 of 15 free");
  await user.click(screen.getByTitle("Toggle all with respect to bfs"));
  // One of the column was held, so all of it becomes free.
  expect(cell("CZ_bfs")).toBeChecked();
  await user.click(screen.getByRole("button", { name: "Free all" }));
  expect(screen.getByTestId("free-count")).toHaveTextContent("15 of 15 free");
});

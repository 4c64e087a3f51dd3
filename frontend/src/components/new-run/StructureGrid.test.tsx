import { screen } from "@testing-library/react";
import userEvent from "@testing-library/user-event";
import { useState } from "react";
import { expect, it } from "vitest";
import { EMPTY_STATES, type States } from "../../lib/structure";
import { useUndo } from "../../lib/drafts/useUndo";
import { show } from "../../test/render";
import { StructureGrid } from "./StructureGrid";

function Grid({ readOnly }: { readOnly?: boolean }) {
  const [states, setStates] = useState<States>(EMPTY_STATES);
  const [current, setCurrent] = useState<string>();
  const { set, undo, redo } = useUndo(states, setStates);
  return (
    <StructureGrid
      axis="longitudinal"
      modes={[7]}
      inputs={["bfs"]}
      states={states}
      onChange={set}
      onUndo={undo}
      onRedo={redo}
      current={current}
      onCurrent={setCurrent}
      readOnly={readOnly}
    />
  );
}

const cell = (name: string) => screen.getByRole("button", { name: new RegExp(`^${name}: `) });
const count = () => screen.getByTestId("free-count");

it("is one tab stop; arrows move, keys set the state and stop at the edges", async () => {
  await show(<Grid />);
  const user = userEvent.setup();
  await user.tab();
  expect(cell("CZ_alpha")).toHaveFocus();
  await user.keyboard("{ArrowLeft}{ArrowUp}");
  expect(cell("CZ_alpha")).toHaveFocus();
  await user.keyboard("{ArrowRight}{ArrowDown}x");
  expect(cell("Cm_q")).toHaveFocus();
  expect(cell("Cm_q")).toHaveAccessibleName("Cm_q: fixed to the start of the run");
  await user.keyboard("{ArrowRight} ");
  expect(cell("Cm_eta7")).toHaveAttribute("data-state", "absent");
  expect(count()).toHaveTextContent("13 of 15 free, 1 fixed, 1 absent");
  await user.keyboard("f{End} ");
  expect(cell("Cm_bfs")).toHaveAttribute("data-state", "absent");
  await user.keyboard(" ");
  expect(count()).toHaveTextContent("14 of 15 free, 1 fixed, 0 absent");
});

it("takes changes back and makes them again", async () => {
  await show(<Grid />);
  const user = userEvent.setup();
  await user.tab();
  await user.keyboard("x{ArrowRight} ");
  expect(count()).toHaveTextContent("13 of 15 free, 1 fixed, 1 absent");
  await user.keyboard("{Control>}z{/Control}");
  expect(count()).toHaveTextContent("14 of 15 free, 1 fixed, 0 absent");
  await user.keyboard("{Control>}z{/Control}");
  expect(count()).toHaveTextContent("15 of 15 free");
  await user.keyboard("{Control>}yy{/Control}");
  expect(count()).toHaveTextContent("13 of 15 free, 1 fixed, 1 absent");
});

it("fixes and frees a whole row or column by its name", async () => {
  await show(<Grid />);
  const user = userEvent.setup();
  await user.click(screen.getByTitle("All of CZ"));
  expect(count()).toHaveTextContent("10 of 15 free");
  await user.click(screen.getByTitle("All with respect to bfs"));
  // One of the column was held, so all of it becomes free.
  expect(count()).toHaveTextContent("11 of 15 free");
  await user.click(screen.getByRole("button", { name: "Free all" }));
  expect(count()).toHaveTextContent("15 of 15 free");
});

it("changes nothing where an older version is read", async () => {
  await show(<Grid readOnly />);
  const user = userEvent.setup();
  await user.tab();
  await user.keyboard("x {ArrowRight}x");
  await user.click(screen.getByTitle("All of CZ"));
  expect(count()).toHaveTextContent("15 of 15 free");
});

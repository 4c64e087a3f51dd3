import { expect, it } from "vitest";
import { figureHeight, themedLayout } from "./figureLayout";

it("adds the theme without overruling the server", () => {
  const layout = themedLayout(
    { xaxis: { type: "log", gridcolor: "red" }, yaxis2: { title: { text: "q" } } },
    "dark",
    300,
    "same",
  );
  expect(layout).toMatchObject({ height: 300, uirevision: "same", paper_bgcolor: "rgba(0,0,0,0)" });
  expect(layout.xaxis).toMatchObject({ type: "log", gridcolor: "red", automargin: true });
  expect(layout.yaxis2).toMatchObject({ title: { text: "q", standoff: 8 } });
});

it("grows with the rows that the server counts", () => {
  expect(figureHeight({})).toBeLessThan(figureHeight({ meta: { rows: 4 } }));
});

import { expect, it } from "vitest";
import {
  figureHeight,
  figureLeastWidth,
  inUnits,
  themedData,
  themedLayout,
  windowed,
} from "./figureLayout";

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

it("shows points of a dark scale on the dark page", () => {
  const points = { type: "scatter", marker: { colorscale: "Cividis", size: 7 } };
  const area = { type: "heatmap", colorscale: "Cividis" };
  expect(themedData([points, area], "light")).toEqual([points, area]);
  const [bright, same] = themedData([points, area], "dark");
  expect(bright).toMatchObject({
    marker: {
      colorscale: [
        [0, "#7d93c4"],
        [0.5, "#b5ae93"],
        [1, "#fee838"],
      ],
      size: 7,
    },
  });
  expect(same).toBe(area);
});

it("is not narrower than the server states", () => {
  expect(figureLeastWidth({})).toBeUndefined();
  expect(figureLeastWidth({ meta: { least_width: 700 } })).toBe(700);
});

it("grows with the rows that the server counts", () => {
  expect(figureHeight({})).toBeLessThan(figureHeight({ meta: { rows: 4 } }));
});

it("shows a window on linear and logarithmic axes, and reads it back", () => {
  const log = { xaxis: { type: "log" } };
  expect(windowed(log, [0.1, 10]).xaxis).toMatchObject({ range: [-1, 1], autorange: false });
  expect(inUnits(log, [-1, 1])).toEqual([0.1, 10]);
  expect(windowed({ xaxis: {} }, [2, 3]).xaxis).toMatchObject({ range: [2, 3] });
  expect(inUnits({}, [1.23456789, 2])).toEqual([1.23457, 2]);
  expect(windowed(log, [0, 10])).toBe(log);
  expect(windowed(log, undefined)).toBe(log);
});

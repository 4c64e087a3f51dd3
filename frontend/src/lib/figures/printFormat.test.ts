import { expect, it } from "vitest";
import { knownFormat, presetOf, PRESETS, printedFigure } from "./printFormat";

const SPEC = {
  data: [{ type: "scatter", x: [1], y: [2] }],
  layout: { xaxis: { title: { text: "t" } }, annotations: [{ text: "a", font: { size: 6 } }] },
};
const SCREEN = {
  width: 800,
  height: 400,
  layout: { xaxis: { range: [2, 3], autorange: false } },
};

it("prints a figure in its size and font, on white, in the window that is shown", () => {
  const { figure, width, height } = printedFigure(
    SPEC,
    SCREEN,
    { width_mm: 25.4, height_mm: 50.8, font_pt: 18 },
    "a < b",
  );
  expect([width, height]).toEqual([96, 192]);
  expect(figure.layout).toMatchObject({
    paper_bgcolor: "#ffffff",
    font: { size: 24 },
    title: { text: "a &lt; b" },
    xaxis: { range: [2, 3], autorange: false, title: { text: "t", font: { size: 24 } } },
    annotations: [{ font: { size: 12 } }],
  });
});

it("prints in the size of the page without a format", () => {
  const { figure, width, height } = printedFigure(SPEC, SCREEN, {}, "");
  expect([width, height]).toEqual([800, 400]);
  expect(figure.layout).not.toHaveProperty("title");
});

it("reads formats within limits, and names their preset", () => {
  expect(knownFormat({ width_mm: 2, height_mm: "x", font_pt: 8 })).toEqual({
    width_mm: undefined,
    height_mm: undefined,
    font_pt: 8,
  });
  expect(presetOf({})).toBe("page");
  expect(presetOf({ font_pt: 9 })).toBe("own");
  for (const preset of PRESETS) expect(presetOf(preset)).toBe(preset.value);
});

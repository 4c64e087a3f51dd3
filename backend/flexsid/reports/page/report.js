"use strict";
// Draws every figure of the report; one that fails says so and leaves the others alone.
const AXIS = {
  gridcolor: "#e9ecef", zerolinecolor: "#adb5bd", linecolor: "#adb5bd", tickcolor: "#adb5bd",
  tickfont: { color: "#495057" }, title: { font: { color: "#495057", size: 12 }, standoff: 8 },
  automargin: true, zeroline: false, exponentformat: "power",
};
// The printed report has lower figures, of which several stand on a page.
const IS_PRINTED = location.hash === "#print";
const LAYOUT = {
  width: 880, // of the text; on paper the style sheet makes it smaller
  paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
  font: { family: "system-ui, sans-serif", size: 12, color: "#212529" },
  margin: { l: 56, r: 16, t: 28, b: 44 },
  legend: { orientation: "h", x: 0, y: 1, yanchor: "bottom" },
  hovermode: "closest", xaxis: {}, yaxis: {},
};
const isObject = (value) => typeof value === "object" && value !== null && !Array.isArray(value);

function under(defaults, own) {
  if (!isObject(own)) return defaults;
  const merged = { ...defaults };
  for (const [key, value] of Object.entries(own)) {
    merged[key] = isObject(merged[key]) && isObject(value) ? under(merged[key], value) : value;
  }
  return merged;
}

function height(layout) {
  const rows = Math.max(1, layout.meta?.rows ?? 1);
  if (IS_PRINTED) return rows <= 2 ? 150 + 120 * rows : 80 + rows * (rows <= 4 ? 110 : 62);
  return rows <= 2 ? 180 + 200 * rows : 90 + rows * (rows <= 4 ? 200 : 150);
}

async function draw(target, spec) {
  const layout = under(LAYOUT, spec.layout);
  const ratio = layout.font.size / LAYOUT.font.size; // of a figure that is printed for a paper
  for (const key of Object.keys(layout)) {
    if (!/^[xy]axis\d*$/.test(key)) continue;
    layout[key] = under(AXIS, layout[key]);
    layout[key] = under(layout[key], { title: { font: { size: layout.font.size } } });
  }
  layout.margin = Object.fromEntries(
    Object.entries(layout.margin).map(([side, size]) => [side, ratio * size]),
  );
  if (layout.title) {
    layout.margin.t += 2 * layout.font.size;
    const place = { y: 1, yref: "container", yanchor: "top", pad: { t: 0.5 * layout.font.size } };
    layout.title = { ...layout.title, ...place, font: { size: 1.2 * layout.font.size } };
  }
  for (const one of layout.annotations ?? []) {
    one.font = { ...one.font, size: ratio * (one.font?.size ?? LAYOUT.font.size) };
  }
  layout.height ??= height(spec.layout);
  // Plotly offers to send figures to its own cloud unless it is told not to.
  const config = { displaylogo: false, responsive: false, showSendToCloud: false };
  await Plotly.newPlot(target, spec.data, layout, config);
}

async function drawAll() {
  for (const script of document.querySelectorAll("figure > script")) {
    const target = script.previousElementSibling;
    try {
      await draw(target, JSON.parse(script.textContent));
    } catch (error) {
      target.textContent = `This figure could not be drawn: ${error}`;
    }
  }
  document.documentElement.dataset.drawn = "true";
}

void drawAll();

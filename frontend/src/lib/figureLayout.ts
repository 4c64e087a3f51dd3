/** What the browser adds to a figure that the server built: theme, size, memory of zoom. */

type Layout = Record<string, unknown>;

interface Ink {
  text: string;
  quiet: string;
  grid: string;
  line: string;
  surface: string;
}

const INK: Record<"light" | "dark", Ink> = {
  light: {
    text: "#212529",
    quiet: "#495057",
    grid: "#e9ecef",
    line: "#adb5bd",
    surface: "#ffffff",
  },
  dark: { text: "#d7d9dd", quiet: "#b0b4ba", grid: "#33363b", line: "#5c6067", surface: "#242424" },
};

const isObject = (value: unknown): value is Layout =>
  typeof value === "object" && value !== null && !Array.isArray(value);

/** Server values win over ours, at every depth. */
function under(defaults: Layout, own: unknown): Layout {
  if (!isObject(own)) return defaults;
  const merged: Layout = { ...defaults };
  for (const [key, value] of Object.entries(own)) {
    const base = merged[key];
    merged[key] = isObject(base) && isObject(value) ? under(base, value) : value;
  }
  return merged;
}

/** Height that keeps every row of panels readable; the server counts them in `meta.rows`. [px] */
export function figureHeight(layout: Layout): number {
  const meta = layout.meta;
  const rows = isObject(meta) && typeof meta.rows === "number" ? Math.max(1, meta.rows) : 1;
  if (rows <= 2) return 180 + 200 * rows;
  return 90 + rows * (rows <= 4 ? 200 : 150);
}

export function themedLayout(
  layout: Layout,
  scheme: "light" | "dark",
  height: number,
  revision: string,
): Layout {
  const ink = INK[scheme];
  const axis = {
    gridcolor: ink.grid,
    zerolinecolor: ink.line,
    linecolor: ink.line,
    tickcolor: ink.line,
    tickfont: { color: ink.quiet },
    title: { font: { color: ink.quiet, size: 12 }, standoff: 8 },
    automargin: true,
    zeroline: false,
  };
  const merged = under(
    {
      autosize: true,
      paper_bgcolor: "rgba(0,0,0,0)",
      plot_bgcolor: "rgba(0,0,0,0)",
      font: { family: '"Inter Variable", system-ui, sans-serif', size: 12, color: ink.text },
      margin: { l: 56, r: 16, t: 28, b: 44 },
      legend: { orientation: "h", x: 0, y: 1, yanchor: "bottom", bgcolor: "rgba(0,0,0,0)" },
      hoverlabel: {
        bgcolor: ink.surface,
        bordercolor: ink.line,
        font: { color: ink.text, size: 12 },
      },
      modebar: { bgcolor: "rgba(0,0,0,0)", color: ink.line, activecolor: ink.text },
      hovermode: "closest",
      xaxis: {},
      yaxis: {},
    },
    layout,
  );
  for (const key of Object.keys(merged)) {
    if (/^[xy]axis\d*$/.test(key)) merged[key] = under(axis, merged[key]);
  }
  return { ...merged, height, width: undefined, uirevision: revision };
}

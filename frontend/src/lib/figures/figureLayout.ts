/** Theme, size and stored zoom of a figure from the server. */

type Layout = Record<string, unknown>;

export interface Ink {
  text: string;
  quiet: string;
  grid: string;
  line: string;
  surface: string;
}

/** Colors of figures. */
export const INK: Record<"light" | "dark", Ink> = {
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

/** Height with readable rows of panels; the server counts them in `meta.rows`, or gives `meta.height`. [px] */
export function figureHeight(layout: Layout): number {
  const meta = layout.meta;
  if (isObject(meta) && typeof meta.height === "number") return meta.height;
  const rows = isObject(meta) && typeof meta.rows === "number" ? Math.max(1, meta.rows) : 1;
  if (rows <= 2) return 180 + 200 * rows;
  return 90 + rows * (rows <= 4 ? 200 : 150);
}

/** Width below which the labels of a figure overlap, if the server states one. [px] */
export function figureLeastWidth(layout: Layout): number | undefined {
  const meta = layout.meta;
  return isObject(meta) && typeof meta.least_width === "number" ? meta.least_width : undefined;
}

const isLogarithmic = (layout: Layout) => isObject(layout.xaxis) && layout.xaxis.type === "log";

/** Plotly gives the range of a logarithmic axis in powers of ten. */
export function inUnits(layout: Layout, range: [number, number]): [number, number] {
  const unit = isLogarithmic(layout) ? (power: number) => 10 ** power : (value: number) => value;
  return [rounded(unit(range[0])), rounded(unit(range[1]))];
}

/** Enough digits for any zoom, few enough for an address. */
export const rounded = (value: number) => Number(value.toPrecision(6));

/** Shows a window of the x axis; all panels that stand over it follow. */
export function windowed(layout: Layout, window: [number, number] | undefined): Layout {
  if (window === undefined) return layout;
  const log = isLogarithmic(layout);
  if (log && window[0] <= 0) return layout;
  const range = log ? window.map(Math.log10) : window;
  return { ...layout, xaxis: { ...(layout.xaxis as Layout), range, autorange: false } };
}

/** Scales of color whose dark end would vanish on the dark page, begun where it is seen. */
const BRIGHT: Record<string, [number, string][]> = {
  Cividis: [
    [0, "#7d93c4"],
    [0.5, "#b5ae93"],
    [1, "#fee838"],
  ],
};

/** Points colored by a scale, visible on either page; areas retain their scale. */
export function themedData(data: Layout[], scheme: "light" | "dark"): Layout[] {
  if (scheme === "light") return data;
  return data.map((trace) => {
    const marker = trace.marker;
    if (!isObject(marker) || typeof marker.colorscale !== "string") return trace;
    const bright = BRIGHT[marker.colorscale];
    return bright === undefined ? trace : { ...trace, marker: { ...marker, colorscale: bright } };
  });
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
    exponentformat: "power",
  };
  // One cursor through all panels that stand over the same axis.
  const cursor = {
    showspikes: true,
    spikemode: "across",
    spikesnap: "cursor",
    spikethickness: 1,
    spikedash: "dot",
    spikecolor: ink.quiet,
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
      hoversubplots: "axis",
      xaxis: {},
      yaxis: {},
    },
    layout,
  );
  for (const key of Object.keys(merged)) {
    if (/^yaxis\d*$/.test(key)) merged[key] = under(axis, merged[key]);
    if (/^xaxis\d*$/.test(key)) merged[key] = under({ ...axis, ...cursor }, merged[key]);
  }
  return { ...merged, height, width: undefined, uirevision: revision };
}

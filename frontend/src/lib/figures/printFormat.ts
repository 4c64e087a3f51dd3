/** Size, font and title of a figure as it is printed. */
import { themedData, themedLayout } from "./figureLayout";

type Layout = Record<string, unknown>;

/** Undefined members are those of the page. */
export interface PrintFormat {
  /** Size of the figure [mm]. */
  width_mm?: number;
  height_mm?: number;
  /** Size of the font [pt]. */
  font_pt?: number;
}

/** Columns of AIAA papers (3.25 in and 6.75 in wide); slides of 13.33 in by 7.5 in. */
export const PRESETS: readonly (Required<PrintFormat> & { value: string; label: string })[] = [
  { value: "slide", label: "Slide 16:9", width_mm: 338.7, height_mm: 190.5, font_pt: 18 },
  { value: "half-column", label: "Half column", width_mm: 82.6, height_mm: 62, font_pt: 8 },
  { value: "full-column", label: "Full column", width_mm: 171.5, height_mm: 114, font_pt: 8 },
];

/** Limits of the API. */
export const SIZE_MM: [number, number] = [20, 1000];
export const FONT_PT: [number, number] = [4, 72];

const PX_PER_MM = 96 / 25.4; // of CSS, in which plotly counts
const PX_PER_PT = 96 / 72;
const SCREEN_FONT_PX = 12;
const PRINT_DPI = 300;

const within = (value: unknown, [least, most]: [number, number]): number | undefined =>
  typeof value === "number" && value >= least && value <= most ? value : undefined;

/** The valid part of what an address or the storage gives. */
export function knownFormat(given: { [Name in keyof PrintFormat]: unknown }): PrintFormat {
  return {
    width_mm: within(given.width_mm, SIZE_MM),
    height_mm: within(given.height_mm, SIZE_MM),
    font_pt: within(given.font_pt, FONT_PT),
  };
}

export const isOfPage = (format: PrintFormat): boolean =>
  Object.values(format).every((value) => value === undefined);

/** Name of the preset that a format is of, "page" or "own". */
export function presetOf(format: PrintFormat): string {
  if (isOfPage(format)) return "page";
  const found = PRESETS.find(
    (one) =>
      one.width_mm === format.width_mm &&
      one.height_mm === format.height_mm &&
      one.font_pt === format.font_pt,
  );
  return found?.value ?? "own";
}

interface Screen {
  width: number;
  height: number;
  /** Layout as it is drawn, with the zoom of the user. */
  layout: Layout;
}

/** A figure on white paper, in the window that is shown, with size and resolution of its image. */
export function printedFigure(
  spec: { data: Layout[]; layout: Layout },
  screen: Screen,
  format: PrintFormat,
  title: string,
) {
  const width = format.width_mm === undefined ? screen.width : format.width_mm * PX_PER_MM;
  const height = format.height_mm === undefined ? screen.height : format.height_mm * PX_PER_MM;
  const font = format.font_pt === undefined ? SCREEN_FONT_PX : format.font_pt * PX_PER_PT;
  const ratio = font / SCREEN_FONT_PX;
  const layout: Layout = { ...themedLayout(spec.layout, "light", height, "print"), width };
  layout.paper_bgcolor = layout.plot_bgcolor = "#ffffff";
  layout.font = { ...(layout.font as Layout), size: font };
  const margin = { l: 56 * ratio, r: 16 * ratio, t: 28 * ratio, b: 44 * ratio };
  layout.margin = margin;
  for (const [key, axis] of Object.entries(layout) as [string, Layout][]) {
    if (!/^[xy]axis\d*$/.test(key)) continue;
    const own = axis.title as { font?: Layout };
    const shown = screen.layout[key] as { autorange?: unknown; range?: unknown } | undefined;
    layout[key] = {
      ...axis,
      title: { ...own, font: { ...own.font, size: font } },
      ...(shown?.autorange === false && { range: shown.range, autorange: false }),
    };
  }
  if (Array.isArray(layout.annotations)) {
    layout.annotations = (layout.annotations as { font?: { size?: number } }[]).map((one) => ({
      ...one,
      font: { ...one.font, size: ratio * (one.font?.size ?? SCREEN_FONT_PX) },
    }));
  }
  if (title !== "") {
    layout.title = {
      text: title.replaceAll("&", "&amp;").replaceAll("<", "&lt;"),
      font: { size: 1.2 * font },
      y: 1,
      yref: "container",
      yanchor: "top",
      pad: { t: 0.5 * font },
    };
    layout.margin = { ...margin, t: margin.t + 2 * font };
  }
  return {
    figure: { data: themedData(spec.data, "light"), layout },
    width: Math.round(width),
    height: Math.round(height),
    scale: PRINT_DPI / 96,
  };
}

import type { PrintFormat } from "../../lib/figures/printFormat";

export interface FigureEvents {
  /** A point with an id was clicked. */
  onPick?: (id: number) => void;
  /** The x axis was zoomed to a window, over frequency in Hz, or reset (null). */
  onWindow?: (window: [number, number] | null) => void;
  /** Quantity of the x axis, where figures of the page share a cursor over it. */
  link?: string;
}

export interface PlotlyHandle {
  /** Saves the figure as it is on the page, or in a format for print under a title. */
  download: (
    format: "png" | "svg",
    filename: string,
    print?: { format: PrintFormat; title: string },
  ) => void;
}

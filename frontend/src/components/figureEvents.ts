export interface FigureEvents {
  /** A point with an id was clicked. */
  onPick?: (id: number) => void;
  /** The x axis was zoomed to a window, over frequency in Hz, or reset (null). */
  onWindow?: (window: [number, number] | null) => void;
  /** Quantity of the x axis, where figures of the page share a cursor over it. */
  link?: string;
}

export interface PlotlyHandle {
  download: (format: "png" | "svg", filename: string) => void;
}

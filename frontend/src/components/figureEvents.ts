export interface FigureEvents {
  /** A point with an id was clicked. */
  onPick?: (id: number) => void;
  /** The x axis was zoomed to a window, in its units, or reset (null). */
  onWindow?: (window: [number, number] | null) => void;
}

export interface PlotlyHandle {
  download: (format: "png" | "svg", filename: string) => void;
}

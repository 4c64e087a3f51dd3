import { useComputedColorScheme } from "@mantine/core";
import { useEffect, useRef } from "react";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { INK, type Ink } from "../../lib/figures/figureLayout";

type PlotOptions = Omit<uPlot.Options, "width" | "height">;

interface Props {
  label: string;
  height: number;
  /** Series, scales and axes in the colors of the theme; a new function draws a new plot. */
  options: (ink: Ink, scheme: "light" | "dark") => PlotOptions;
  /** Called with the plot, and with null before it is removed. */
  onPlot: (plot: uPlot | null) => void;
}

/** A plot over time that is drawn again as often as data arrive; plotly draws everything else. */
export function Plot({ label, height, options, onPlot }: Props) {
  const scheme = useComputedColorScheme("light");
  const element = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const target = element.current;
    if (target === null) return;
    const size = () => ({ width: Math.max(80, target.clientWidth), height });
    const plot = new uPlot({ ...options(INK[scheme], scheme), ...size() }, [[]], target);
    onPlot(plot);
    const observer = new ResizeObserver(() => {
      plot.setSize(size());
    });
    observer.observe(target);
    return () => {
      observer.disconnect();
      onPlot(null);
      plot.destroy();
    };
  }, [scheme, height, options, onPlot]);
  return <div ref={element} role="img" aria-label={label} style={{ height, minWidth: 0 }} />;
}

/** Axis in the colors of the theme. */
export function axis(ink: Ink, more: uPlot.Axis = {}): uPlot.Axis {
  return {
    stroke: ink.quiet,
    font: FONT,
    grid: { stroke: ink.grid, width: 1 },
    ticks: { stroke: ink.line, width: 1, size: 4 },
    ...more,
  };
}

const FONT = '12px "Inter Variable", system-ui, sans-serif';

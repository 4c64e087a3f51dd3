import { useEffect, useRef, useState } from "react";
import type { FigureSpec } from "../../api/types";
import {
  figureLeastWidth,
  inUnits,
  themedData,
  themedLayout,
  windowed,
} from "../../lib/figures/figureLayout";
import { printedFigure } from "../../lib/figures/printFormat";
import { followCursor } from "./linkedCursor";
import type { FigureEvents, PlotlyHandle } from "./figureEvents";
import { loadPlotly } from "./plotly";

interface Props extends FigureEvents {
  spec: FigureSpec;
  scheme: "light" | "dark";
  height: number;
  /** Zoom is retained while this is unchanged. */
  revision: string;
  window?: [number, number];
  onReady: (handle: PlotlyHandle) => void;
}

const CONFIG = {
  displaylogo: false,
  showSendToCloud: false, // on by default: flight data are not uploaded
  responsive: false,
  doubleClick: "reset",
  modeBarButtonsToRemove: [
    "select2d",
    "lasso2d",
    "autoScale2d",
    "toImage",
    "zoomIn2d",
    "zoomOut2d",
  ],
};

/** Ids that the server put behind a point. */
function firstId(customdata: unknown): number | null {
  const first: unknown = Array.isArray(customdata) ? customdata[0] : customdata;
  return typeof first === "number" ? first : null;
}

/** Draws one spec; a spec that cannot be drawn becomes an error of this figure alone. */
export function PlotlyCanvas({ spec, scheme, height, revision, ...props }: Props) {
  const element = useRef<HTMLDivElement>(null);
  const cursor = useRef<HTMLDivElement>(null);
  const { link } = props;
  const latest = useRef(props);
  const [failure, setFailure] = useState<Error | null>(null);
  useEffect(() => {
    latest.current = props;
  });

  useEffect(() => {
    const target = element.current;
    if (target === null) return;
    let stale = false;
    const draw = async () => {
      const Plotly = await loadPlotly();
      if (stale) return;
      // Plotly writes into what it is given; the fetched spec stays as it came.
      const { data, layout } = structuredClone(spec);
      const drawn = await Plotly.react(
        target,
        themedData(data, scheme),
        // No dependency: each navigation gives another array of the same numbers, and the
        // revision shows a change.
        windowed(themedLayout(layout, scheme, height, revision), latest.current.window),
        CONFIG,
      );
      drawn.removeAllListeners("plotly_click");
      drawn.removeAllListeners("plotly_relayout");
      drawn.removeAllListeners("plotly_doubleclick");
      drawn.on("plotly_click", (click: { points: { customdata?: unknown }[] }) => {
        const id = firstId(click.points[0]?.customdata);
        if (id !== null) latest.current.onPick?.(id);
      });
      drawn.on("plotly_relayout", (change: Record<string, unknown>) => {
        const from = change["xaxis.range[0]"];
        const to = change["xaxis.range[1]"];
        if (typeof from === "number" && typeof to === "number")
          latest.current.onWindow?.(inUnits(layout, [from, to]));
      });
      drawn.on("plotly_doubleclick", () => latest.current.onWindow?.(null));
      latest.current.onReady({
        download: (format, filename, print) => {
          const screen = { width: target.clientWidth, height, layout: drawn.layout };
          if (print === undefined) {
            const scale = format === "png" ? 2 : 1;
            void Plotly.downloadImage(target, { ...screen, format, filename, scale });
            return;
          }
          const printed = printedFigure(structuredClone(spec), screen, print.format, print.title);
          const { figure, width, scale } = printed;
          const size = { width, height: printed.height, scale: format === "png" ? scale : 1 };
          void Plotly.downloadImage(figure, { ...size, format, filename });
        },
      });
    };
    draw().catch((error: unknown) => {
      if (!stale) setFailure(error instanceof Error ? error : new Error(String(error)));
    });
    return () => {
      stale = true;
    };
  }, [spec, scheme, height, revision]);

  useEffect(() => {
    if (link === undefined || element.current === null || cursor.current === null) return;
    return followCursor(link, element.current, cursor.current);
  }, [link]);

  useEffect(() => {
    const target = element.current;
    if (target === null) return;
    const observer = new ResizeObserver(() => {
      if (target.classList.contains("js-plotly-plot") && target.offsetParent !== null) {
        void loadPlotly().then((Plotly) => Plotly.Plots.resize(target));
      }
    });
    observer.observe(target);
    return () => {
      observer.disconnect();
      void loadPlotly().then((Plotly) => {
        Plotly.purge(target);
      });
    };
  }, []);

  if (failure !== null) throw failure;
  const minWidth = figureLeastWidth(spec.layout);
  const drawing = (
    <div style={{ position: "relative", minWidth }}>
      <div ref={element} style={{ width: "100%", minHeight: height }} />
      <div ref={cursor} className="linked-cursor" aria-hidden="true" />
    </div>
  );
  if (minWidth === undefined) return drawing;
  return (
    <div role="region" aria-label="Wide figure" tabIndex={0} style={{ overflowX: "auto" }}>
      {drawing}
    </div>
  );
}

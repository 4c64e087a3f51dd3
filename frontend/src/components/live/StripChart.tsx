import { useCallback, useEffect, useRef } from "react";
import type uPlot from "uplot";
import { useConversion } from "../../api/units";
import type { Ink } from "../../lib/figures/figureLayout";
import { significant } from "../../lib/text/format";
import { inUnit, STRIP_S, type Envelope, type Strip } from "../../lib/live/strip";
import { axis, Plot } from "./Plot";
import type { DrawingQueue } from "./drawingQueue";

const HEIGHT = 104;

interface Props {
  name: string;
  unit: string;
  strip: Strip;
  /** In the unit of the channel, as the samples. */
  limits?: readonly number[];
  queue: DrawingQueue;
  /** Defect of the data of the channel at present. */
  defect?: string;
}

/** The last seconds of one channel, its present value, and its limits, in display units. */
export function StripChart({ name, unit: si, strip, limits, queue, defect }: Props) {
  const { name: unit, factor } = useConversion()(si);
  const plot = useRef<uPlot | null>(null);
  const value = useRef<HTMLSpanElement>(null);
  const [low, high] = (limits ?? []).map((limit) => factor * limit);
  const draw = useCallback(() => {
    if (value.current !== null)
      value.current.textContent = significant(strip.last === null ? null : factor * strip.last, 3);
    const end = strip.end_s;
    if (plot.current === null || end === null) return;
    plot.current.batch(() => {
      plot.current?.setData(inUnit(strip.envelope(), factor), false);
      plot.current?.setScale("x", { min: end - STRIP_S, max: end });
    });
  }, [strip, factor]);
  useEffect(() => queue.add(draw), [queue, draw]);

  const options = useCallback(
    (ink: Ink, scheme: "light" | "dark") => ({
      legend: { show: false },
      cursor: { show: false },
      padding: [6, 8, 0, 0] as uPlot.Padding,
      scales: {
        x: { time: false },
        y: {
          range: (_: uPlot, least: number, greatest: number): uPlot.Range.MinMax =>
            padded([least, greatest, low, high]),
        },
      },
      axes: [
        axis(ink, { size: 22, space: 60 }),
        axis(ink, { size: 56, space: 24, values: (_, ticks) => ticks.map((t) => String(t)) }),
      ],
      series: [{}, SCALED, SCALED],
      hooks: {
        draw: [
          (drawn: uPlot) => {
            drawEnvelope(drawn, TRACE[scheme]);
            drawLimits(drawn, low, high, LIMIT[scheme]);
          },
        ],
      },
    }),
    [low, high],
  );
  const onPlot = useCallback(
    (created: uPlot | null) => {
      plot.current = created;
      draw();
    },
    [draw],
  );

  return (
    <figure className="strip" data-testid={`strip-${name}`} data-defect={defect !== undefined}>
      <figcaption>
        <span className="strip-name">{name}</span>
        <span className="numbers">
          <span ref={value} className="strip-value" /> <span className="unit">{unit}</span>
        </span>
        {limits !== undefined && (
          <span className="quiet numbers">
            limits {significant(low, 3)} to {significant(high, 3)}
          </span>
        )}
        {defect !== undefined && <strong className="strip-defect">{defect}</strong>}
      </figcaption>
      <Plot
        label={`Last ${STRIP_S} s of ${name} [${unit}] over time [s]`}
        height={HEIGHT}
        options={options}
        onPlot={onPlot}
      />
    </figure>
  );
}

/** A series that scales the plot, but is not drawn by it. */
const SCALED = { paths: () => null, points: { show: false } };

const TRACE = { light: "#155877", dark: "#8ecbe8" };
const LIMIT = { light: "#c92a2a", dark: "#ff8787" };

/** Range of all numbers with a margin; a constant has one, too. */
function padded(values: (number | null | undefined)[]): [number, number] {
  const known = values.filter((value): value is number => Number.isFinite(value));
  if (known.length === 0) return [-1, 1];
  const [low, high] = [Math.min(...known), Math.max(...known)];
  const margin = 0.08 * (high - low) || 0.1 * Math.abs(high) || 1;
  return [low - margin, high + margin];
}

interface Column {
  left: number;
  top: number;
  bottom: number;
}

/**
 * Draws columns of pixels from the smallest to the largest sample. Stroked paths look the same, but
 * cost a browser without graphics processor about ten times as much.
 */
function drawEnvelope(plot: uPlot, color: string) {
  const { ctx, bbox } = plot;
  const [times, lows, highs] = plot.data as Envelope;
  const [x, y] = [plot.scales.x, plot.scales.y];
  if (x?.min == null || x.max == null || y?.min == null || y.max == null) return;
  const thickness = Math.max(1, Math.round(1.5 * devicePixelRatio));
  const perSecond = bbox.width / (x.max - x.min);
  const perUnit = bbox.height / (y.max - y.min);
  ctx.fillStyle = color;
  const fill = (column: Column | null) => {
    if (column === null) return;
    const { left, top, bottom } = column;
    ctx.fillRect(left, top, thickness, Math.max(thickness, bottom - top));
  };
  let column = null as Column | null;
  for (const [index, time] of times.entries()) {
    const [low, high] = [lows[index] ?? null, highs[index] ?? null];
    const left = Math.round(bbox.left + (time - x.min) * perSecond);
    if (low === null || high === null) {
      fill(column);
      column = null;
      continue;
    }
    let top = Math.round(bbox.top + (y.max - high) * perUnit);
    let bottom = Math.round(bbox.top + (y.max - low) * perUnit);
    if (column?.left === left) {
      column = { left, top: Math.min(top, column.top), bottom: Math.max(bottom, column.bottom) };
      continue;
    }
    fill(column);
    if (column !== null) {
      // Columns touch, so that steep lines have no gaps.
      top = Math.min(top, column.bottom);
      bottom = Math.max(bottom, column.top);
    }
    column = { left, top, bottom };
  }
  fill(column);
}

function drawLimits(plot: uPlot, low: number | undefined, high: number | undefined, color: string) {
  const { ctx, bbox } = plot;
  for (const limit of [low, high]) {
    if (limit === undefined) continue;
    const y = plot.valToPos(limit, "y", true);
    ctx.save();
    ctx.strokeStyle = color;
    ctx.lineWidth = 1.5 * devicePixelRatio;
    ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
    ctx.restore();
  }
}

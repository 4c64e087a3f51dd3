import { useCallback, useEffect, useRef } from "react";
import type uPlot from "uplot";
import type { Ink } from "../../lib/figures/figureLayout";
import type { Tracks } from "../../lib/live/tracks";
import { axis, Plot } from "./Plot";

/** Colors of modes, apart also for who sees no red and green; contrast 3:1 on either page. */
export const MODE_COLORS = {
  light: ["#155877", "#a63a00", "#6741a5", "#07694b", "#8a5a00", "#9c2a6c"],
  dark: ["#8ecbe8", "#ff9d66", "#b9a0ee", "#5fd0a8", "#e6c15c", "#f191c4"],
};

const DASHES: number[][] = [[], [7, 3], [2, 3], [9, 3, 2, 3]];

/** Linear near the limit of stability, logarithmic beyond: lightly damped modes matter most. */
const STABILITY: uPlot.Scale = {
  // Its enumeration is only declared and does not exist at run time.
  // eslint-disable-next-line @typescript-eslint/no-unsafe-enum-assignment
  distr: 4, // inverse hyperbolic sine
  asinh: 0.05,
  range: (_, low, high) => [Math.min(1.1 * low, -0.05), Math.max(1.1 * high, 0.1)],
};
const DAMPING_AXIS: uPlot.Axis = {
  size: 60,
  splits: (_plot, _axis, low, high) =>
    [-1, -0.5, -0.2, -0.1, -0.05, 0, 0.05, 0.1, 0.2, 0.5, 1].filter(
      (tick) => tick >= low && tick <= high,
    ),
  filter: (_plot, ticks) => ticks,
  values: (_plot, ticks) => ticks.map(String),
};

interface Props {
  label: string;
  height: number;
  tracks: Tracks;
  /** Draws a line at zero: the limit of stability. */
  zero?: boolean;
}

/** Estimates of every mode over time, with bands of two standard errors. */
export function TrackPlot({ label, height, tracks, zero = false }: Props) {
  const plot = useRef<uPlot | null>(null);
  const latest = useRef(tracks);
  const names = tracks.tracks.map((track) => track.name).join("\n");
  const draw = useCallback(() => {
    const { times, tracks: lines } = latest.current;
    plot.current?.setData([times, ...lines.flatMap((one) => [one.values, one.low, one.high])]);
  }, []);
  useEffect(() => {
    latest.current = tracks;
    draw();
  }, [tracks, draw]);

  const options = useCallback(
    (ink: Ink, scheme: "light" | "dark") => {
      const modes = names === "" ? [] : names.split("\n");
      const color = (index: number) =>
        MODE_COLORS[scheme][index % MODE_COLORS[scheme].length] ?? ink.text;
      return {
        legend: { show: false },
        cursor: { show: false },
        padding: [6, 12, 0, 0] as uPlot.Padding,
        scales: {
          x: { time: false },
          y: zero ? STABILITY : {},
        },
        axes: [
          axis(ink, { size: 40, space: 60, label: "Time [s]", labelSize: 18, labelFont: "12px" }),
          axis(ink, zero ? DAMPING_AXIS : { size: 60, space: 28 }),
        ],
        series: [
          {},
          ...modes.flatMap((_, index) => [
            {
              stroke: color(index),
              width: 2,
              dash: DASHES[index % DASHES.length],
              points: { show: true, size: 5, fill: color(index) },
            },
            { stroke: "transparent", points: { show: false } },
            { stroke: "transparent", points: { show: false } },
          ]),
        ],
        bands: modes.map((_, index) => ({
          series: [3 * index + 3, 3 * index + 2] as [number, number],
          fill: `${color(index)}33`,
        })),
        hooks: {
          drawAxes: [
            (drawn: uPlot) => {
              if (zero) drawZero(drawn, ink.text);
            },
          ],
        },
      };
    },
    [names, zero],
  );
  const onPlot = useCallback(
    (created: uPlot | null) => {
      plot.current = created;
      draw();
    },
    [draw],
  );
  return <Plot label={label} height={height} options={options} onPlot={onPlot} />;
}

function drawZero(plot: uPlot, color: string) {
  const { ctx, bbox } = plot;
  const y = plot.valToPos(0, "y", true);
  ctx.save();
  ctx.strokeStyle = color;
  ctx.lineWidth = 1.5 * devicePixelRatio;
  ctx.beginPath();
  ctx.moveTo(bbox.left, y);
  ctx.lineTo(bbox.left + bbox.width, y);
  ctx.stroke();
  ctx.restore();
}

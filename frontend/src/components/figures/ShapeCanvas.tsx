import { useComputedColorScheme } from "@mantine/core";
import { useEffect, useRef, useState, type KeyboardEvent, type PointerEvent } from "react";
import type { ModeShape } from "../../api/types";
import { toScreen, type Camera, type Point } from "../../lib/figures/projection";

interface Props {
  shape: ModeShape;
  /** Largest displacement as a share of the span. */
  scale: number;
  playing: boolean;
  camera: Camera;
  onCamera: (camera: Camera) => void;
  height?: number;
}

const INK = {
  light: { still: "#adb5bd", moved: "#111111", sensor: "#d55e00" },
  dark: { still: "#5c6067", moved: "#f1f3f5", sensor: "#ff922b" },
};
const SECONDS = 1.6;
const NEAR = 14;

/** One mode drawn in lines: undeformed faint, deformed strong; drag turns it, the wheel zooms. */
export function ShapeCanvas({ shape, scale, playing, camera, onCamera, height = 420 }: Props) {
  const scheme = useComputedColorScheme("light");
  const canvas = useRef<HTMLCanvasElement>(null);
  const [width, setWidth] = useState(600);
  const [hover, setHover] = useState<{ x: number; y: number; sensor: number } | null>(null);
  const dragged = useRef<{ x: number; y: number } | null>(null);

  useEffect(() => {
    const target = canvas.current;
    if (target === null) return;
    const observer = new ResizeObserver(() => {
      setWidth(Math.max(200, target.clientWidth));
    });
    observer.observe(target);
    return () => {
      observer.disconnect();
    };
  }, []);

  useEffect(() => {
    const target = canvas.current;
    const pen = target?.getContext("2d");
    if (target == null || pen == null) return;
    const dense = window.devicePixelRatio || 1;
    target.width = Math.round(width * dense);
    target.height = Math.round(height * dense);
    const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    let frame = 0;
    const draw = (time: number) => {
      pen.setTransform(dense, 0, 0, dense, 0, 0);
      const angle = playing && !still ? (2 * Math.PI * time) / 1000 / SECONDS : Math.PI / 2;
      paint(pen, shape, scale, angle, camera, width, height, INK[scheme]);
      if (playing && !still) frame = requestAnimationFrame(draw);
    };
    frame = requestAnimationFrame(draw);
    return () => {
      cancelAnimationFrame(frame);
    };
  }, [shape, scale, playing, camera, width, height, scheme]);

  const move = (event: PointerEvent<HTMLCanvasElement>) => {
    const start = dragged.current;
    const box = event.currentTarget.getBoundingClientRect();
    if (start !== null) {
      onCamera({
        ...camera,
        azimuth: camera.azimuth - (event.clientX - start.x) * 0.008,
        elevation: clamp(camera.elevation + (event.clientY - start.y) * 0.008),
      });
      dragged.current = { x: event.clientX, y: event.clientY };
      return;
    }
    const x = event.clientX - box.left;
    const y = event.clientY - box.top;
    const place = toScreen(shape.nodes_m, camera, width, height);
    let best = -1;
    let gap = NEAR;
    shape.sensors.forEach((sensor, index) => {
      const [sx, sy] = place(sensor.location_m);
      const distance = Math.hypot(sx - x, sy - y);
      if (distance < gap) [gap, best] = [distance, index];
    });
    setHover(best < 0 ? null : { x, y, sensor: best });
  };
  const turn = (event: KeyboardEvent) => {
    const step = 0.12;
    const turns: Record<string, Partial<Camera>> = {
      ArrowLeft: { azimuth: camera.azimuth + step },
      ArrowRight: { azimuth: camera.azimuth - step },
      ArrowUp: { elevation: clamp(camera.elevation - step) },
      ArrowDown: { elevation: clamp(camera.elevation + step) },
      "+": { zoom: camera.zoom * 1.15 },
      "-": { zoom: camera.zoom / 1.15 },
    };
    const change = turns[event.key];
    if (change === undefined) return;
    event.preventDefault();
    onCamera({ ...camera, ...change });
  };
  const sensor = hover === null ? undefined : shape.sensors[hover.sensor];
  return (
    <div style={{ position: "relative" }}>
      <canvas
        ref={canvas}
        tabIndex={0}
        role="img"
        aria-label={`${shape.name}, ${shape.frequency_hz.toFixed(2)} Hz; arrow keys turn it, plus and minus zoom`}
        data-testid="mode-shape"
        data-nodes={shape.nodes_m.length}
        style={{ width: "100%", height, touchAction: "none", cursor: "grab", display: "block" }}
        onPointerDown={(event) => {
          dragged.current = { x: event.clientX, y: event.clientY };
          event.currentTarget.setPointerCapture(event.pointerId);
        }}
        onPointerUp={() => {
          dragged.current = null;
        }}
        onPointerMove={move}
        onPointerLeave={() => {
          setHover(null);
        }}
        onWheel={(event) => {
          onCamera({ ...camera, zoom: camera.zoom * Math.exp(-event.deltaY * 0.001) });
        }}
        onKeyDown={turn}
      />
      {sensor !== undefined && hover !== null && (
        <div
          className="panel"
          role="status"
          style={{
            position: "absolute",
            left: Math.min(hover.x + 14, width - 210),
            top: Math.max(0, hover.y - 30),
            padding: "6px 10px",
            fontSize: 12,
            pointerEvents: "none",
          }}
        >
          <strong>{sensor.sensor}</strong> {sensor.kind}, {sensor.axis}
          <div>φ = ({sensor.phi_m.map(short).join(", ")}) m</div>
          <div>ν = ({sensor.nu_rad.map(short).join(", ")}) rad</div>
        </div>
      )}
    </div>
  );
}

const short = (value: number) => value.toPrecision(3);
const clamp = (angle: number) => Math.max(-1.55, Math.min(1.55, angle));

function paint(
  pen: CanvasRenderingContext2D,
  shape: ModeShape,
  share: number,
  angle: number,
  camera: Camera,
  width: number,
  height: number,
  ink: { still: string; moved: string; sensor: string },
) {
  pen.clearRect(0, 0, width, height);
  const place = toScreen(shape.nodes_m, camera, width, height);
  const factor = shape.largest_m > 0 ? (share * shape.span_m) / shape.largest_m : 0;
  const [inPhase, ahead] = [factor * Math.sin(angle), factor * Math.cos(angle)];
  const still = shape.nodes_m.map(place);
  const moved = shape.nodes_m.map((node, row) => {
    const d = shape.displacement_m[row] ?? [];
    const q = shape.quadrature_m?.[row] ?? [];
    const there: Point = node.map(
      (value, axis) => value + inPhase * (d[axis] ?? 0) + ahead * (q[axis] ?? 0),
    );
    return place(there);
  });
  for (const [points, color, size] of [
    [still, ink.still, 1],
    [moved, ink.moved, 1.3],
  ] as const) {
    pen.strokeStyle = color;
    pen.lineWidth = size;
    pen.beginPath();
    for (const [from = -1, to = -1] of shape.lines) {
      const a = points[from];
      const b = points[to];
      if (a === undefined || b === undefined) continue;
      pen.moveTo(a[0], a[1]);
      pen.lineTo(b[0], b[1]);
    }
    pen.stroke();
  }
  // Half a turn about y takes body axes back to those of the nodes.
  pen.fillStyle = ink.sensor;
  for (const sensor of shape.sensors) {
    const [x = 0, y = 0, z = 0] = sensor.location_m;
    const [px = 0, py = 0, pz = 0] = sensor.phi_m.map(
      (value, axis) => inPhase * value + ahead * (sensor.quadrature_m?.[axis] ?? 0),
    );
    const at = place([x - px, y + py, z - pz]);
    pen.beginPath();
    pen.arc(at[0], at[1], 3.5, 0, 2 * Math.PI);
    pen.fill();
  }
}

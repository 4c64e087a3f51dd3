/** A structure seen from somewhere: turned, flattened, and fitted into a rectangle. */
/** Three numbers; what is missing is zero. */
export type Point = readonly number[];

export interface Camera {
  /** About the vertical, and up from the horizon [rad]. */
  azimuth: number;
  elevation: number;
  zoom: number;
}

export const CAMERA: Camera = { azimuth: -2.2, elevation: 0.42, zoom: 1 };

/** Sideways and upwards on the screen, in the unit of the point; y grows downwards. */
export function turned(
  [x = 0, y = 0, z = 0]: Point,
  { azimuth, elevation }: Camera,
): [number, number] {
  const right = -Math.sin(azimuth) * x + Math.cos(azimuth) * y;
  const towards = Math.cos(azimuth) * x + Math.sin(azimuth) * y;
  const up = Math.cos(elevation) * z - Math.sin(elevation) * towards;
  return [right, -up];
}

export function middle(points: readonly Point[]): Point {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const point of points) {
    for (let axis = 0; axis < 3; axis += 1) {
      low[axis] = Math.min(low[axis] ?? 0, point[axis] ?? 0);
      high[axis] = Math.max(high[axis] ?? 0, point[axis] ?? 0);
    }
  }
  const at = (axis: number) => ((low[axis] ?? 0) + (high[axis] ?? 0)) / 2;
  return points.length === 0 ? [0, 0, 0] : [at(0), at(1), at(2)];
}

/** A function from a place to the screen that leaves a border around the undeformed structure. */
export function toScreen(
  points: readonly Point[],
  camera: Camera,
  width: number,
  height: number,
): (point: Point) => [number, number] {
  const [cx = 0, cy = 0, cz = 0] = middle(points);
  let radius = 1e-9;
  for (const [x = 0, y = 0, z = 0] of points)
    radius = Math.max(radius, Math.hypot(x - cx, y - cy, z - cz));
  const scale = (camera.zoom * Math.min(width, height * 1.7)) / (2.15 * radius);
  return ([x = 0, y = 0, z = 0]) => {
    const [right, down] = turned([x - cx, y - cy, z - cz], camera);
    return [width / 2 + scale * right, height / 2 + scale * down];
  };
}

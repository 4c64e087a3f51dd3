import { describe, expect, it } from "vitest";
import { CAMERA, middle, toScreen, turned } from "./projection";

describe("projection", () => {
  it("shows what is up as up, from wherever it is seen", () => {
    for (const azimuth of [0, 1, 2, 3]) {
      const [right, down] = turned([0, 0, 1], { azimuth, elevation: 0.4, zoom: 1 });
      expect(right).toBeCloseTo(0);
      expect(down).toBeLessThan(0);
    }
  });

  it("preserves lengths in the view from above", () => {
    const [right, down] = turned([3, 4, 0], { azimuth: 0.7, elevation: Math.PI / 2, zoom: 1 });
    expect(Math.hypot(right, down)).toBeCloseTo(5);
  });

  it("fits the structure into the rectangle", () => {
    const points = [
      [0, -4, 0],
      [3, 0, 0.2],
      [0, 4, 0],
    ] as const;
    expect(middle(points)).toEqual([1.5, 0, 0.1]);
    const place = toScreen(points, CAMERA, 600, 400);
    for (const point of points) {
      const [x, y] = place(point);
      expect(x).toBeGreaterThan(0);
      expect(x).toBeLessThan(600);
      expect(y).toBeGreaterThan(0);
      expect(y).toBeLessThan(400);
    }
  });
});

import { expect, it } from "vitest";
import { inUnit, Strip, STRIP_S } from "./strip";

/** A second of columns as the server sends them; null where no samples arrived. */
function add(strip: Strip, time: number, low: number | null, high = low) {
  const times = Array.from({ length: 20 }, (_, index) => time + 0.05 * index);
  strip.append(
    times,
    0.05,
    times.map(() => low),
    times.map(() => high),
  );
}

/** Lowest and highest value at a time. */
function at(strip: Strip, time: number) {
  const [times, low, high] = strip.envelope();
  const index = times.findIndex((one) => Math.abs(one - time) <= 0.026);
  return [low[index], high[index]];
}

it("shows the extremes of every column, and the newest value", () => {
  const strip = new Strip();
  add(strip, 0, -9, 9);
  add(strip, 1, 1, 3);
  expect(at(strip, 0.42)).toEqual([-9, 9]);
  expect(at(strip, 1.42)).toEqual([1, 3]);
  expect(strip.last).toBe(2);
});

it("has gaps where samples are missing or were not received", () => {
  const strip = new Strip();
  add(strip, 0, 1);
  add(strip, 1, null);
  add(strip, 3, 3);
  expect(at(strip, 0.5)).toEqual([1, 1]);
  expect(at(strip, 1.5)).toEqual([null, null]);
  expect(at(strip, 2.5)).toEqual([null, null]);
  expect(at(strip, 3.5)).toEqual([3, 3]);
});

it("has the same length however long the stream is, and shows its last seconds", () => {
  const strip = new Strip();
  add(strip, 0, 7);
  const length = strip.envelope()[0].length;
  for (let time = 1; time < 100; time++) add(strip, time, time);
  const [times, low] = strip.envelope();
  expect(times).toHaveLength(length);
  expect(times[0]).toBeCloseTo(100 - STRIP_S, 1);
  expect(low[0]).toBe(100 - STRIP_S);
  expect(strip.end_s).toBeCloseTo(100);
});

it("fills wider columns, adds those that arrive late, and none that are too old", () => {
  const strip = new Strip();
  strip.append([10], 1, [2], [2]);
  strip.append([9], 1, [1], [1]);
  strip.append([-STRIP_S], 1, [99], [99]);
  expect(at(strip, 9.5)).toEqual([1, 1]);
  expect(at(strip, 10.9)).toEqual([2, 2]);
  expect(strip.envelope()[1]).not.toContain(99);
  expect(strip.last).toBe(2);
});

it("is drawn in another unit; what is not known stays so", () => {
  const strip = new Strip();
  add(strip, 0, 2);
  add(strip, 1, 3);
  const [, low, high] = inUnit(strip.envelope(), 10);
  expect([...new Set(low)]).toEqual([null, 20, 30]);
  expect(high.at(-1)).toBe(30);
});

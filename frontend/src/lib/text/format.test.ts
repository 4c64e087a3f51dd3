import { describe, expect, it } from "vitest";
import { converted, elapsed, fixed, relativeError, significant, withError } from "./format";

describe("numbers", () => {
  it("shows a dash where there is none", () => {
    for (const nothing of [null, undefined, NaN, Infinity]) {
      expect(fixed(nothing, 2)).toBe("–");
      expect(significant(nothing)).toBe("–");
    }
  });

  it("writes significant digits over powers of ten", () => {
    expect(significant(0.00012346)).toBe("0.0001235");
    expect(significant(12.346)).toBe("12.35");
    expect(significant(-0.5)).toBe("−0.5000");
    expect(significant(1.5e-7, 2)).toBe("1.5e−7");
    expect(significant(2.5e8, 3)).toBe("2.50e8");
    expect(significant(0)).toBe("0");
  });

  it("rounds a value to two digits of its standard error", () => {
    expect(withError(-0.016412, 0.00011)).toEqual({ value: "−0.01641", error: "0.00011" });
    expect(withError(123.456, 2.3)).toEqual({ value: "123.5", error: "2.3" });
    expect(withError(0.5, null)).toEqual({ value: "0.5000", error: "–" });
  });

  it("has no relative error for what is zero or not identifiable", () => {
    expect(relativeError(-2, 0.1)).toBeCloseTo(5);
    expect(relativeError(0, 0.1)).toBeNull();
    expect(relativeError(1, null)).toBeNull();
  });

  it("formats durations", () => {
    const at = (seconds: number) => new Date(1e12 + 1000 * seconds).toISOString();
    expect(elapsed(at(0), at(0.41))).toBe("0.41 s");
    expect(elapsed(at(0), at(125))).toBe("2 min 05 s");
    expect(elapsed(at(0), null)).toBe("–");
  });
});

it("writes values that round to zero without a sign", () => {
  expect(fixed(-0.0004, 3)).toBe("0.000");
  expect(fixed(-0.0006, 3)).toBe("−0.001");
});

describe("converted", () => {
  it("has about the resolution of the SI value", () => {
    expect(converted(23.15, 3600 / 1852, 1)).toBe("45.0");
    expect(converted(980, 1 / 47.88025898, 0)).toBe("20.47");
    expect(converted(0.0349066, 180 / Math.PI, 4)).toBe("2.00");
    expect(converted(2.5, 2 * Math.PI, 2)).toBe("15.7");
    expect(converted(null, 2, 1)).toBe("–");
  });
});

import { expect, it } from "vitest";
import { atFuel } from "./modes";
import { oscillation, upperHalf } from "./poles";

it("reads frequency and damping off a pole", () => {
  const { omega, damping, omegaStd, dampingStd } = oscillation({
    real: -3,
    imag: 4,
    real_std: 0.1,
    imag_std: 0.2,
  });
  expect(omega).toBeCloseTo(5);
  expect(damping).toBeCloseTo(0.6);
  // First-order propagation, checked against differences of the formulas.
  expect(omegaStd).toBeCloseTo(Math.hypot((3 / 5) * 0.1, (4 / 5) * 0.2));
  expect(dampingStd).toBeCloseTo(Math.hypot((16 / 125) * 0.1, (12 / 125) * 0.2));
});

it("selects one pole of each pair, slowest first", () => {
  const poles = [
    { real: -1, imag: 20 },
    { real: -1, imag: -20 },
    { real: -2, imag: 0 },
  ];
  expect(upperHalf(poles)).toEqual([
    { real: -2, imag: 0 },
    { real: -1, imag: 20 },
  ]);
});

it("interpolates modes over fuel and holds the ends", () => {
  const table = [
    [10, 20],
    [8, 18],
  ];
  expect(atFuel([0, 1], table, 0.5)).toEqual([9, 19]);
  expect(atFuel([0, 1], table, 2)).toEqual([8, 18]);
  expect(atFuel([0, 1], table, 0)).toEqual([10, 20]);
});

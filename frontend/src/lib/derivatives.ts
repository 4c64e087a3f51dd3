/**
 * Derivative names, e.g. `Cm_q`, `CQ7_etadot9`: coefficient before the underscore,
 * variable after it. Rows and columns come in the order of the model.
 */
export interface Derivative {
  coefficient: string;
  variable: string;
}

export function parseDerivative(name: string): Derivative | null {
  const cut = name.indexOf("_");
  if (cut < 1 || !name.startsWith("C")) return null;
  return { coefficient: name.slice(0, cut), variable: name.slice(cut + 1) };
}

/** Coefficients and motions of the rigid body in one axis, as the server names them. */
export interface AxisNames {
  axis: string;
  symmetry: string;
  coefficients: readonly string[];
  motions: readonly string[];
}

const axes = new Map<string, AxisNames>();

/** Store the axes of the server; before, a model has the derivatives of its modes only. */
export function setAxes(known: readonly AxisNames[]): void {
  for (const one of known) axes.set(one.axis, one);
}

export const axisNames = (axis: string): AxisNames =>
  axes.get(axis) ?? { axis, symmetry: "symmetric", coefficients: [], motions: [] };

export const coefficients = (modes: readonly number[], axis: string): string[] => [
  ...axisNames(axis).coefficients,
  ...modes.map((mode) => `CQ${mode}`),
];

export const variables = (
  modes: readonly number[],
  inputs: readonly string[],
  axis: string,
): string[] => [
  ...axisNames(axis).motions,
  ...modes.map((mode) => `eta${mode}`),
  ...modes.map((mode) => `etadot${mode}`),
  ...inputs,
];

export function derivativeNames(
  modes: readonly number[],
  inputs: readonly string[],
  axis: string,
): string[] {
  const columns = variables(modes, inputs, axis);
  return coefficients(modes, axis).flatMap((row) => columns.map((column) => `${row}_${column}`));
}

/** Coefficients that occur in a list of derivative names, in order of first appearance. */
export function coefficientsIn(names: readonly string[]): string[] {
  return [...new Set(names.flatMap((name) => parseDerivative(name)?.coefficient ?? []))];
}

const SYMBOLS: Record<string, string> = { alpha: "α", alphadot: "α̇", beta: "β" };

/** A variable as written in the field: α, q, η₇, η̇₉, wf4s. */
export function variableParts(variable: string): { symbol: string; index: string } {
  const elastic = /^(eta|etadot)(\d+)$/.exec(variable);
  if (elastic) {
    return { symbol: elastic[1] === "eta" ? "η" : "η̇", index: elastic[2] ?? "" };
  }
  return { symbol: SYMBOLS[variable] ?? variable, index: "" };
}

/** Motions, modal coordinates and engines; any other variable is a deflection. */
const NO_DEFLECTION = /^(eta|etadot)\d+$|^(thrust|throttle)|^[Vpqr]$/;

/** What is in the index of a derivative, as the figures write it: `Cm_wf4s` has "m,δwf4s". */
export function derivativeIndex({ coefficient, variable }: Derivative): string {
  const { symbol, index } = variableParts(variable);
  const isMotion = variable in SYMBOLS || NO_DEFLECTION.test(variable);
  const text = `${isMotion ? "" : "δ"}${symbol}${index}`;
  const of = coefficient.slice(1);
  // An index needs a mark between it and what follows; single letters do not.
  return of.length > 1 || text.length > 1 ? `${of},${text}` : `${of}${text}`;
}

/** Ranges of conditions: stored (SI), typed and parsed. */
import { fixed, type Convert } from "./text/format";

export const QUANTITIES = [
  { key: "dynamic_pressure_pa", label: "Dynamic pressure", unit: "Pa", factor: 1 },
  { key: "fuel_fraction", label: "Fuel", unit: "%", factor: 100 },
  { key: "airspeed_m_s", label: "Airspeed", unit: "m/s", factor: 1 },
  { key: "airspeed_ratio", label: "V/V_f", unit: "", factor: 1 },
  { key: "alpha_rad", label: "Angle of attack", unit: "deg", factor: 180 / Math.PI },
] as const;
type QuantityKey = (typeof QUANTITIES)[number]["key"];

/** Limits as the API has them: closed intervals by quantity. */
export type Limits = Partial<Record<QuantityKey, readonly (number | string)[]>>;

/** Limits as they are typed, in the units of ``QUANTITIES``. */
export type TypedLimits = Partial<Record<QuantityKey, [string, string]>>;

const unconverted: Convert = (name) => ({ name, factor: 1 });

export function limitsText(limits: Limits, convert: Convert = unconverted): string {
  const parts = QUANTITIES.flatMap(({ key, label, unit, factor }) => {
    const pair = limits[key];
    if (pair === undefined) return [];
    const display = convert(unit);
    const [low, high] = pair.map((value) =>
      String(Number((Number(value) * factor * display.factor).toPrecision(4))),
    );
    return [`${label} ${low} to ${high} ${display.name}`.trim()];
  });
  return parts.length > 0 ? parts.join(", ") : "All conditions";
}

export function typed(limits: Limits): TypedLimits {
  const pairs = QUANTITIES.flatMap(({ key, factor }) => {
    const pair = limits[key];
    if (pair === undefined) return [];
    const shown = pair.map((value) => String(Number((Number(value) * factor).toPrecision(10))));
    return [[key, [shown[0] ?? "", shown[1] ?? ""]] as const];
  });
  return Object.fromEntries(pairs);
}

/** Typed limits as the API takes them, or why they cannot be taken. */
export function readLimits(
  given: TypedLimits,
): { limits: Partial<Record<QuantityKey, [number, number]>> } | { fault: string } {
  const limits: Partial<Record<QuantityKey, [number, number]>> = {};
  for (const { key, label, unit, factor } of QUANTITIES) {
    const pair = given[key];
    if (pair === undefined) continue;
    const [low, high] = pair.map((text) =>
      text.trim() === "" ? NaN : Number(text.trim().replace(",", ".")) / factor,
    );
    if (low === undefined || high === undefined || !Number.isFinite(low + high)) {
      return { fault: `Give both limits of ${label.toLowerCase()} as numbers, or remove it.` };
    }
    if (low >= high) {
      const shown = [low, high].map((value) => fixed(value * factor, 2)).join(" and ");
      return { fault: `${label} ${shown} ${unit}: the first limit must lie below the second.` };
    }
    limits[key] = [low, high];
  }
  return { limits };
}

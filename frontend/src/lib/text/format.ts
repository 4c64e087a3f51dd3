/** Text of numbers, dates and durations. */

const MINUS = "\u2212";
const NONE = "\u2013";

type Maybe = number | null | undefined;

// A value that rounds to zero has no sign.
const signed = (text: string) =>
  Number(text) === 0 ? text.replace("-", "") : text.replace("-", MINUS);

/** Fixed decimals; a dash where there is no number. */
export function fixed(value: Maybe, decimals: number): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
  return signed(value.toFixed(decimals));
}

/** Fixed decimals with a sign, and what follows the number. */
export const signedWith = (value: number, decimals: number, unit: string): string =>
  `${value > 0 && Number(value.toFixed(decimals)) !== 0 ? "+" : ""}${fixed(value, decimals)}${unit}`;

/** An SI value in another unit, with about the resolution of its decimals in SI. */
export function converted(value: Maybe, factor: number, decimals: number): string {
  const places = Math.ceil(decimals - Math.log10(factor) - 0.25);
  return fixed(value == null ? value : factor * value, Math.min(Math.max(0, places), 9));
}

/** Significant digits; powers of ten only where plain digits would mislead. */
export function significant(value: Maybe, digits = 4): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
  if (value === 0) return "0";
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  if (exponent < -4 || exponent >= 6) {
    const [mantissa = "", power = "0"] = value.toExponential(digits - 1).split("e");
    return signed(`${mantissa}e${Number(power)}`);
  }
  return signed(value.toFixed(Math.max(0, digits - 1 - exponent)));
}

/** A value rounded to two significant digits of its standard error. */
export function withError(value: number, stdError: Maybe): { value: string; error: string } {
  if (stdError === null || stdError === undefined || !(stdError > 0)) {
    return { value: significant(value), error: NONE };
  }
  const decimals = 1 - Math.floor(Math.log10(stdError));
  if (decimals < 0 || decimals > 6 || Math.abs(value) >= 1e6) {
    return { value: significant(value), error: significant(stdError, 2) };
  }
  return { value: fixed(value, decimals), error: fixed(stdError, decimals) };
}

/** Standard error in percent of the value. */
export function relativeError(value: number, stdError: Maybe): number | null {
  if (stdError === null || stdError === undefined || value === 0) return null;
  return (100 * stdError) / Math.abs(value);
}

export function percent(fraction: Maybe, decimals = 0): string {
  return fraction === null || fraction === undefined ? NONE : fixed(100 * fraction, decimals);
}

export const degrees = (radians: number): number => (radians * 180) / Math.PI;
export const hertz = (omega: number): number => omega / (2 * Math.PI);

/** Local date and time to the second, in the order that sorts. */
export function dateTime(iso: string | null | undefined): string {
  if (iso === null || iso === undefined) return NONE;
  const at = new Date(iso);
  if (Number.isNaN(at.getTime())) return NONE;
  const two = (part: number) => String(part).padStart(2, "0");
  const day = `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())}`;
  return `${day} ${two(at.getHours())}:${two(at.getMinutes())}:${two(at.getSeconds())}`;
}

/** Local date and time to the minute, for lists. */
export const dateMinute = (iso: string | null | undefined): string => dateTime(iso).slice(0, 16);

/** Flight number in a list; pre-flight simulations are stored as flight 0. */
export const flightNumber = (number: number): string => (number === 0 ? "simulated" : `${number}`);

/** Name of a flight. */
export const flightName = (number: number): string =>
  number === 0 ? "Pre-flight simulations" : `Flight ${number}`;

/** Time between two moments. */
export function elapsed(from: string | null | undefined, to: string | null | undefined): string {
  if (!from || !to) return NONE;
  return duration((new Date(to).getTime() - new Date(from).getTime()) / 1000);
}

/** A time, e.g. `0.41 s`, `2 min 05 s`, `3 h 20 min`. */
export function duration(seconds: number): string {
  if (seconds < 60) return `${fixed(Math.max(0, seconds), seconds < 10 ? 2 : 1)} s`;
  if (seconds >= 3600) {
    return `${Math.floor(seconds / 3600)} h ${Math.floor((seconds % 3600) / 60)} min`;
  }
  return `${Math.floor(seconds / 60)} min ${String(Math.floor(seconds % 60)).padStart(2, "0")} s`;
}

/** `1 run`, `3 runs`. */
export const count = (number: number, noun: string): string =>
  `${number} ${noun}${number === 1 ? "" : "s"}`;

/** Name of the display unit of a unit, and displayed value over value in the unit. */
export type Convert = (unit: string) => { name: string; factor: number };

/** The number that a text of a draft is; undefined where nothing, or no number, is typed. */
export function typedNumber(text: string | undefined): number | undefined {
  const value = text === undefined || text.trim() === "" ? NaN : Number(text.replace(",", "."));
  return Number.isFinite(value) ? value : undefined;
}

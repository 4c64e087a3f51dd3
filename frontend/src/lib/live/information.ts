import { count, percent } from "../text/format";

/**
 * Whether the maneuver may stop early, from the part of the expected Fisher information that each
 * derivative has; undefined where none is expected.
 */
export function adviseDuration(parts: readonly number[]): string | undefined {
  if (parts.length === 0) return undefined;
  const complete = parts.filter((part) => part >= 1).length;
  const of = `${String(complete)} of ${count(parts.length, "derivative")} with the expected information`;
  return complete === parts.length
    ? `Enough to stop early: ${of}`
    : `Not yet enough: ${of}, the least has ${percent(Math.min(...parts))} %`;
}

/** Defects of a channel in words. */
import { count, fixed } from "../format";

interface Health {
  missing_s: number;
  spikes: number;
  is_frozen: boolean;
  is_excluded: boolean;
}

/** Defect at present; undefined for spikes and short gaps of the past. */
export function describeDefect(health: Health): string | undefined {
  if (health.is_frozen) return "FROZEN";
  if (health.is_excluded) return "NO DATA, excluded";
  return undefined;
}

/** All defects in the maneuver. */
export function describeHealth(health: Health): string {
  const parts = [
    health.is_frozen && "frozen",
    health.is_excluded && "excluded from the estimate",
    health.missing_s > 0 && `${fixed(health.missing_s, 2)} s missing`,
    health.spikes > 0 && count(health.spikes, "spike"),
  ];
  return parts.filter((part) => part !== false).join(", ");
}

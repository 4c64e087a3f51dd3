/** Defects of a channel in words. */
import { count, fixed } from "../text/format";

interface Health {
  missing_s: number;
  spikes: number;
  is_frozen: boolean;
  is_excluded: boolean;
}

interface Reception {
  is_connected: boolean | null;
  connection_error: string;
  interruptions: number;
  interrupted_s: number;
  rejected: number;
  rejection: string;
  lost_messages: number;
}

/** Connection and messages of a receiver; empty where there is nothing to report. */
export function describeReception(reception: Reception): string[] {
  const { is_connected, connection_error, interruptions, interrupted_s } = reception;
  const parts = [
    is_connected === false && `NOT CONNECTED${connection_error && `: ${connection_error}`}`,
    is_connected === true && "Connected.",
    interruptions > 0 &&
      `Connection lost ${count(interruptions, "time")}, for ${fixed(interrupted_s, 1)} s in all.`,
    reception.rejected > 0 &&
      `${count(reception.rejected, "message")} rejected; the newest: ${reception.rejection}`,
    reception.lost_messages > 0 && `${count(reception.lost_messages, "message")} lost.`,
  ];
  return parts.filter((part) => part !== false);
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

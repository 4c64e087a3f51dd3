/** Whether data arrive: by the clock of the browser, so that a silent server is noticed, too. */

/** Data as old as this are late: parameters have to be at most a second old. [ms] */
const LATE_MS = 1000;

/** Data as old as this are lost: five times the longest jitter of a radio link, and an estimate. [ms] */
const LOST_MS = 3000;

export type Freshness = "waiting" | "current" | "late" | "lost" | "ended";

interface Reception {
  /** When the last data arrived; null before the first. [ms] */
  received_ms: number | null;
  hasEnded: boolean;
}

/** State of the reception now. [ms] */
export function assessFreshness({ received_ms, hasEnded }: Reception, now_ms: number): Freshness {
  if (hasEnded) return "ended";
  if (received_ms === null) return "waiting";
  const age = now_ms - received_ms;
  if (age >= LOST_MS) return "lost";
  return age >= LATE_MS ? "late" : "current";
}

import { Badge } from "@mantine/core";
import type { Verdict } from "../api/types";
import { tint } from "../lib/tint";

export const VERDICT_COLORS: Record<Verdict, string> = {
  good: "green",
  doubtful: "yellow",
  bad: "red",
  unchecked: "gray",
};

/** Whether a maneuver may be estimated from; the word says it, the color only helps. */
export function VerdictBadge({ verdict }: { verdict: Verdict | null }) {
  if (verdict === null) return <span className="quiet">not looked at</span>;
  return (
    <Badge
      bg={tint(VERDICT_COLORS[verdict])}
      c="var(--mantine-color-text)"
      tt="none"
      miw="max-content"
      data-testid={`verdict-${verdict}`}
    >
      {verdict === "unchecked" ? "cannot be checked" : verdict}
    </Badge>
  );
}

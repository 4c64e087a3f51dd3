import { Badge } from "@mantine/core";
import type { Verdict } from "../../api/types";
import { tint } from "../../lib/figures/tint";

export const VERDICT_COLORS: Record<Verdict, string> = {
  good: "green",
  questionable: "yellow",
  bad: "red",
  unchecked: "gray",
};

/** Verdict on the data quality of a maneuver. */
export function VerdictBadge({ verdict }: { verdict: Verdict | null }) {
  if (verdict === null) return <span className="quiet">not checked</span>;
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

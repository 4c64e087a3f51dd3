import { Badge } from "@mantine/core";
import type { DecisionState } from "../api/types";

const COLORS: Record<DecisionState, string> = {
  open: "blue",
  "changes-requested": "yellow",
  approved: "teal",
  rejected: "red",
  withdrawn: "gray",
  superseded: "gray",
};

/** Where a decision stands, as color and word. */
export function DecisionBadge({ state }: { state: DecisionState }) {
  const color = COLORS[state];
  return (
    <Badge
      bg={`light-dark(var(--mantine-color-${color}-1), color-mix(in srgb, var(--mantine-color-${color}-9) 55%, #242424))`}
      c="var(--mantine-color-text)"
      tt="none"
      data-testid="decision-state"
      data-state={state}
    >
      {state.replace("-", " ")}
    </Badge>
  );
}

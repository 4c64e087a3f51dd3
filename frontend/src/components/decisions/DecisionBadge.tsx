import { Badge } from "@mantine/core";
import type { DecisionState } from "../../api/types";
import { tint } from "../../lib/figures/tint";

const COLORS: Record<DecisionState, string> = {
  open: "blue",
  "changes-requested": "yellow",
  approved: "teal",
  rejected: "red",
  withdrawn: "gray",
  superseded: "gray",
};

/** State of a decision as color and text. */
export function DecisionBadge({ state }: { state: DecisionState }) {
  return (
    <Badge
      bg={tint(COLORS[state])}
      c="var(--mantine-color-text)"
      tt="none"
      data-testid="decision-state"
      data-state={state}
    >
      {state.replace("-", " ")}
    </Badge>
  );
}

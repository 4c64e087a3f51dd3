import { Badge, Loader } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import type { Method, RunState } from "../../api/types";
import { tint } from "../../lib/figures/tint";

const COLORS: Record<RunState, string> = {
  queued: "gray",
  running: "blue",
  succeeded: "teal",
  failed: "red",
  cancelled: "yellow",
};

/** State of a run as color and text. */
export function StateBadge({ state }: { state: RunState }) {
  return (
    <Badge
      bg={tint(COLORS[state])}
      c="var(--mantine-color-text)"
      tt="none"
      miw="max-content"
      leftSection={state === "running" ? <Loader size={9} color={COLORS[state]} /> : undefined}
      data-testid="run-state"
      data-state={state}
    >
      {state}
    </Badge>
  );
}

/** Link to the latest run of one method, with its state. */
export function RunBadge({
  method,
  run,
}: {
  method: Method;
  run: { id: number; state: RunState };
}) {
  return (
    <Link
      to="/runs/$id"
      params={{ id: run.id }}
      aria-label={`${method} run ${run.id}, ${run.state}`}
      title={`${method} run ${run.id}: ${run.state}`}
      style={{ textDecoration: "none" }}
    >
      <Badge
        bg={tint(COLORS[run.state])}
        c="var(--mantine-color-text)"
        style={{ cursor: "pointer" }}
      >
        {method}
      </Badge>
    </Link>
  );
}

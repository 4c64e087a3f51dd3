import { Button } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import { useAnalyst } from "../../api/analyst";
import { useDecideTestPoint } from "../../api/commands";
import type { LiveState, LiveTestPoint } from "../../api/types";
import { fixed } from "../../lib/text/format";
import { DataTable, type Column } from "../controls/DataTable";
import { ProblemAlert } from "../display/ProblemAlert";

const STEPS = ["Planned", "Flying", "Recorded", "Accepted", "Repeat"] as const;
type Step = (typeof STEPS)[number];

const OF_STATUS: Record<LiveTestPoint["status"], Step> = {
  stored: "Recorded",
  refused: "Recorded",
  accepted: "Accepted",
  repeat: "Repeat",
};

interface Props {
  phase: LiveState["phase"] | null;
  /** The last test point of the stream. */
  last: LiveTestPoint | null;
}

/** Where the present test point is, from planned to accepted or to be repeated. */
export function TestPointStrip({ phase, last }: Props) {
  const step: Step =
    phase === "excited" ? "Flying" : last === null ? "Planned" : OF_STATUS[last.status];
  return (
    <ol className="live-steps" aria-label="Test point" data-testid="test-point" data-step={step}>
      {STEPS.map((one) => (
        <li key={one} aria-current={one === step ? "step" : undefined}>
          {one}
        </li>
      ))}
    </ol>
  );
}

/** Flown test points with the stored maneuver and its run; the last ones first. */
export function TestPoints({ points }: { points: readonly LiveTestPoint[] }) {
  const name = useAnalyst();
  const decide = useDecideTestPoint();
  const columns: Column<LiveTestPoint>[] = [
    {
      key: "time",
      header: "Time",
      unit: "s",
      render: (point) => `${fixed(point.start_s, 1)} to ${fixed(point.stop_s, 1)}`,
    },
    {
      key: "maneuver",
      header: "Maneuver",
      wraps: true,
      render: (point) =>
        point.maneuver_id === null ? (
          point.message || "not stored"
        ) : (
          <Link
            to="/maneuvers/$id"
            params={{ id: point.maneuver_id }}
            className="link"
            data-testid="stored-maneuver"
          >
            Maneuver {point.maneuver_id}
          </Link>
        ),
    },
    {
      key: "run",
      header: "Run",
      render: (point) =>
        point.run_id === null ? (
          "–"
        ) : (
          <Link to="/runs/$id" params={{ id: point.run_id }} className="link">
            Run {point.run_id}
          </Link>
        ),
    },
    {
      key: "status",
      header: "Status",
      render: (point) => (
        <>
          {OF_STATUS[point.status]}
          {point.author !== "" && <span className="quiet"> by {point.author}</span>}
        </>
      ),
    },
    {
      key: "decision",
      header: "Decision",
      render: (point) =>
        name === "" ? (
          <span className="quiet">Set your name to decide</span>
        ) : (
          (["accepted", "repeat"] as const).map((status) => (
            <Button
              key={status}
              mr={6}
              variant="default"
              disabled={point.status === status}
              loading={decide.isPending && decide.variables.id === point.id}
              data-testid={`decide-${status}`}
              onClick={() => {
                decide.mutate({ id: point.id, status });
              }}
            >
              {status === "accepted" ? "Accept" : "Repeat"}
            </Button>
          ))
        ),
    },
  ];
  return (
    <>
      <DataTable
        label="Test points"
        testId="test-points"
        columns={columns}
        rows={[...points].reverse()}
        rowKey={(point) => point.id}
      />
      {decide.isError && <ProblemAlert error={decide.error} />}
    </>
  );
}

import { Checkbox, Group } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { runsQuery } from "../../api/queries";
import type { RunItem } from "../../api/types";
import { dateTime, elapsed } from "../../lib/text/format";
import { latestPerMethod } from "../runs/latestRuns";
import { CompareLink } from "../runs/CompareLink";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Empty } from "../display/Empty";
import { Loaded } from "../display/Loaded";
import { AdequacyBadge } from "../runs/ModelAdequacy";
import { StateBadge } from "../runs/RunBadge";
import type { ManeuverTabProps } from "./TimeHistoryTab";

const columns: Column<RunItem>[] = [
  {
    key: "id",
    header: "Run",
    render: (run) => (
      <Link to="/runs/$id" params={{ id: run.id }} className="link">
        {run.method} run {run.id}
      </Link>
    ),
  },
  { key: "state", header: "State", render: (run) => <StateBadge state={run.state} /> },
  {
    key: "axis",
    header: "Axis",
    onlyIf: (run) => run.axis !== "longitudinal",
    render: (run) => run.axis,
  },
  { key: "modes", header: "Modes", render: (run) => run.modes.join(", ") || "rigid" },
  { key: "start", header: "Start", help: "Start", render: (run) => run.start.replaceAll("-", " ") },
  {
    key: "outcome",
    header: "Outcome",
    help: "Outcome",
    render: (run) => run.outcome ?? run.error_code ?? "",
  },
  {
    key: "adequacy",
    header: "Model adequacy",
    help: "adequacy",
    onlyIf: (run) => run.adequacy !== null,
    render: (run) => run.adequacy !== null && <AdequacyBadge state={run.adequacy} />,
  },
  numeric("iterations", "Iterations", (run) => run.n_iterations ?? ""),
  numeric("took", "Duration", (run) => elapsed(run.started_at, run.finished_at)),
  { key: "at", header: "Requested", numeric: true, render: (run) => dateTime(run.created_at) },
];

/** Runs of this maneuver; ticked ones can be compared. */
export function ManeuverRuns({ maneuver, view, onChange }: ManeuverTabProps) {
  const runs = useQuery(runsQuery({ maneuver_id: maneuver.id }));
  const selected = view.selected ?? [];
  const tick: Column<RunItem> = {
    key: "select",
    header: <span className="quiet">Compare</span>,
    render: (run) => (
      <Checkbox
        aria-label={`Compare run ${run.id}`}
        disabled={run.state !== "succeeded"}
        checked={selected.includes(run.id)}
        onChange={(event) => {
          onChange({
            selected: event.currentTarget.checked
              ? [...selected, run.id]
              : selected.filter((id) => id !== run.id),
          });
        }}
      />
    ),
  };
  return (
    <Loaded query={runs}>
      {(rows) =>
        rows.length === 0 ? (
          <Empty title="No runs yet">
            <Link to="/maneuvers/$id/new-run" params={{ id: maneuver.id }} className="link">
              Estimate derivatives from this maneuver
            </Link>
          </Empty>
        ) : (
          <>
            <Group justify="flex-end" mb="xs">
              <CompareLink
                runs={
                  selected.length > 0
                    ? rows.filter((run) => selected.includes(run.id))
                    : latestPerMethod(rows)
                }
                label={
                  selected.length > 0 ? `Compare ${selected.length} selected` : "Compare methods"
                }
              />
            </Group>
            <div className="panel">
              <DataTable
                label="Runs"
                testId="runs-table"
                columns={[tick, ...columns]}
                rows={rows}
                rowKey={(run) => run.id}
              />
            </div>
          </>
        )
      }
    </Loaded>
  );
}

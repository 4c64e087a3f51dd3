import { Link } from "@tanstack/react-router";
import type { RunItem } from "../../api/types";
import { dateMinute, dateTime, fixed, flightNumber } from "../../lib/text/format";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { AdequacyBadge } from "./ModelAdequacy";
import { StateBadge } from "./RunBadge";
import { selectColumn } from "../controls/selectColumn";
import { Tags } from "../controls/Tags";

interface Props {
  runs: RunItem[];
  selected: number[];
  onSelect: (ids: number[]) => void;
  sort: string;
  onSort: (sort: string) => void;
}

const columns: Column<RunItem>[] = [
  {
    key: "run",
    header: "Run",
    sort: "id",
    render: (run) => (
      <Link to="/runs/$id" params={{ id: run.id }} className="link nowrap">
        {run.method} run {run.id}
      </Link>
    ),
  },
  {
    key: "state",
    header: "State",
    sort: "state",
    render: (run) => <StateBadge state={run.state} />,
  },
  {
    key: "maneuver",
    header: "Maneuver",
    sort: "maneuver_label",
    yields: true,
    render: (run) => (
      <Link to="/maneuvers/$id" params={{ id: run.maneuver_id }} className="link">
        {run.maneuver_label}
      </Link>
    ),
  },
  {
    key: "flight",
    header: "Flight",
    sort: "flight_number",
    numeric: true,
    render: (run) => flightNumber(run.flight_number),
  },
  {
    key: "ratio",
    header: (
      <>
        V/V<sub>f</sub>
      </>
    ),
    help: "airspeed_ratio",
    sort: "airspeed_ratio",
    numeric: true,
    render: (run) => fixed(run.airspeed_ratio, 3),
  },
  { key: "modes", header: "Modes", render: (run) => run.modes.join(", ") || "rigid" },
  {
    key: "outcome",
    header: "Outcome",
    help: "Outcome",
    render: (run) =>
      run.changed_since.length > 0 ? (
        <span title={`Changed since: ${run.changed_since.join(", ")}`}>
          {run.outcome}, data changed since
        </span>
      ) : (
        (run.outcome ?? run.error_code ?? "")
      ),
  },
  {
    key: "fit",
    header: "Worst R²",
    help: "Worst R²",
    numeric: true,
    render: (run) => fixed(run.worst_r_squared, 3),
  },
  {
    key: "adequacy",
    header: "Model adequacy",
    help: "adequacy",
    onlyIf: (run) => run.adequacy !== null,
    render: (run) => run.adequacy !== null && <AdequacyBadge state={run.adequacy} />,
  },
  numeric("warnings", "Warnings", (run) => run.n_warnings ?? ""),
  {
    key: "tags",
    header: "Tags",
    onlyIf: (run) => run.tags.length > 0,
    yields: true,
    render: (run) => <Tags tags={run.tags} />,
  },
  {
    key: "author",
    header: "Author",
    sort: "author",
    onlyIf: (run) => run.author !== "",
    yields: true,
    render: (run) => run.author,
  },
  {
    key: "at",
    header: "Requested",
    sort: "created_at",
    numeric: true,
    render: (run) => <span title={dateTime(run.created_at)}>{dateMinute(run.created_at)}</span>,
  },
];

/** Runs with their request, state and quality of fit. */
export function RunList({ runs, selected, onSelect, sort, onSort }: Props) {
  const select = selectColumn(runs, selected, onSelect, (run) => `${run.method} run ${run.id}`);
  return (
    <DataTable
      label="Runs"
      testId="run-list"
      columns={[select, ...columns]}
      rows={runs}
      rowKey={(run) => run.id}
      rowTestId={(run) => `run-row-${run.id}`}
      isSelected={(run) => selected.includes(run.id)}
      sort={sort}
      onSort={onSort}
    />
  );
}

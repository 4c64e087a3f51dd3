import { Group } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import { METHODS, type ManeuverItem } from "../../api/types";
import { fixed, flightNumber, percent } from "../../lib/text/format";
import { DataTable, type Column } from "../controls/DataTable";
import { Quantity, UnitName } from "../display/Quantity";
import { RunBadge } from "../runs/RunBadge";
import { selectColumn } from "../controls/selectColumn";
import { Tags } from "../controls/Tags";
import type { CampaignView } from "../../views";
import { QUALITY_COLUMNS, VERDICT_COLUMN } from "../quality/QualityAssessment";

interface Props {
  /** Columns beside maneuver and flight; condition and runs by default. */
  columns?: CampaignView["columns"];
  maneuvers: ManeuverItem[];
  selected: number[];
  onSelect: (ids: number[]) => void;
  sort: string;
  onSort: (sort: string) => void;
}

/** Condition and runs of a maneuver. */
const RUN_COLUMNS: Column<ManeuverItem>[] = [
  {
    key: "airspeed",
    header: "V",
    unit: <UnitName unit="m/s" />,
    sort: "airspeed_m_s",
    numeric: true,
    render: (one) => <Quantity value={one.airspeed_m_s} unit="m/s" decimals={1} />,
  },
  {
    key: "fuel",
    header: "Fuel",
    help: "fuel_fraction",
    unit: "%",
    sort: "fuel_fraction",
    numeric: true,
    render: (one) => percent(one.fuel_fraction),
  },
  {
    key: "duration",
    header: "Length",
    unit: "s",
    sort: "duration_s",
    numeric: true,
    render: (one) => fixed(one.duration_s, 1),
  },
  {
    key: "correlation",
    header: "Input corr.",
    help: "Input corr.",
    sort: "max_input_correlation",
    numeric: true,
    render: (one) => fixed(one.max_input_correlation, 2),
  },
  { ...VERDICT_COLUMN, key: "quality", header: "Quality" },
  {
    key: "runs",
    header: "Runs",
    render: (one) => (
      <Group gap={4} wrap="nowrap">
        {METHODS.map((method) => {
          const run = one.runs[method];
          return run ? <RunBadge key={method} method={method} run={run} /> : null;
        })}
        {one.n_runs === 0 && <span className="quiet">none</span>}
      </Group>
    ),
  },
  {
    key: "tags",
    header: "Tags",
    onlyIf: (one) => one.tags.length > 0,
    yields: true,
    render: (one) => <Tags tags={one.tags} />,
  },
];

/** Maneuvers with where they were flown and how far their estimation is. */
export function ManeuverList({ columns, maneuvers, selected, onSelect, sort, onSort }: Props) {
  const shown: Column<ManeuverItem>[] = [
    selectColumn(maneuvers, selected, onSelect, (one) => one.label),
    {
      key: "label",
      header: "Maneuver",
      sort: "label",
      yields: true,
      render: (one) => (
        <Link to="/maneuvers/$id" params={{ id: one.id }} className="link">
          {one.label}
        </Link>
      ),
    },
    {
      key: "flight",
      header: "Flight",
      sort: "flight_number",
      numeric: true,
      render: (one) => (
        <Link to="/flights/$id" params={{ id: one.flight_id }} className="link">
          {flightNumber(one.flight_number)}
        </Link>
      ),
    },
    {
      key: "fta",
      header: "FTA",
      help: "FTA",
      sort: "fta",
      numeric: true,
      render: (one) => one.fta ?? "–",
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
      render: (one) => fixed(one.airspeed_ratio, 3),
    },
    ...(columns === "quality" ? QUALITY_COLUMNS : RUN_COLUMNS),
  ];
  return (
    <DataTable
      label="Maneuvers"
      testId="campaign-table"
      columns={shown}
      rows={maneuvers}
      rowKey={(one) => one.id}
      rowTestId={(one) => `maneuver-row-${one.id}`}
      isSelected={(one) => selected.includes(one.id)}
      sort={sort}
      onSort={onSort}
    />
  );
}

import { Text } from "@mantine/core";
import type { Comparison, ComparisonRow } from "../../api/types";
import { fixed, withError } from "../../lib/text/format";
import { DataTable, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { UnitOf } from "../display/UnitOf";

interface Props extends Pick<Comparison, "sources" | "rows"> {
  /** Place of the source that the others are held against. */
  baseline?: number;
}

/** The same derivatives as the bars, as numbers; with a baseline, how far each is from it. */
export function ComparisonTable({ sources, rows, baseline }: Props) {
  const names = rows.map((row) => row.name);
  const columns: Column<ComparisonRow>[] = [
    {
      key: "name",
      header: "Derivative",
      render: (row) => (
        <>
          <DerivativeName name={row.name} />
          <UnitOf name={row.name} among={names} />
        </>
      ),
    },
    {
      key: "difference",
      header: "Runs differ",
      help: "Runs differ",
      unit: "σ",
      numeric: true,
      render: (row) => fixed(row.max_difference_sigma, 1),
    },
    {
      key: "consistent",
      header: (
        <span title="Of the runs among each other; predictions take no part">Consistent</span>
      ),
      render: (row) =>
        row.consistent == null ? (
          <span className="quiet">–</span>
        ) : (
          <Text
            span
            size="sm"
            c={row.consistent ? "var(--page-good)" : "var(--page-warn)"}
            title={
              row.consistent
                ? `The runs differ by at most ${fixed(row.limit_sigma, 2)} standard errors of the difference`
                : `At least one pair of runs differs by more than ${fixed(row.limit_sigma, 2)} standard errors of the difference`
            }
          >
            {row.consistent ? "yes" : "no"}
          </Text>
        ),
    },
    ...sources.map((source, index): Column<ComparisonRow> => ({
      key: source.key,
      header: rows.some((row) => row.values[index]?.std_error != null)
        ? `${source.label} ±2σ`
        : source.label,
      numeric: true,
      render: (row) => {
        const cell = row.values[index];
        if (cell == null) return <span className="quiet">–</span>;
        const { value, error } = withError(
          cell.value,
          cell.std_error == null ? null : 2 * cell.std_error,
        );
        const base = baseline === undefined || baseline === index ? null : row.values[baseline];
        return (
          <span
            style={{ whiteSpace: "nowrap" }}
            title={departure(cell)}
            data-departs={cell.consistent === false}
          >
            <span style={cell.consistent === false ? DEPARTS : undefined}>{value}</span>
            {cell.std_error != null && <span className="quiet"> ± {error}</span>}
            {cell.rests_on != null && (
              <span className="quiet" title={cell.rests_on} data-testid="rests-on">
                {" "}
                †
              </span>
            )}
            {base != null && <Difference from={base} to={cell} />}
          </span>
        );
      },
    })),
  ];
  return (
    <DataTable
      label="Comparison"
      testId="comparison-table"
      columns={columns}
      rows={rows}
      rowKey={(row) => row.name}
      isSelected={(row) => row.consistent === false}
    />
  );
}

type Cell = NonNullable<ComparisonRow["values"][number]>;

const DEPARTS = { color: "var(--page-warn)" };

/** How far a prediction is from the run that it differs from most. */
const departure = (cell: Cell) =>
  cell.difference_sigma == null
    ? undefined
    : `Up to ${fixed(cell.difference_sigma, 1)}σ from the runs`;

/** In joint standard errors where there are any, else in percent. */
function Difference({ from, to }: { from: Cell; to: Cell }) {
  const joint = Math.hypot(from.std_error ?? 0, to.std_error ?? 0);
  const sigmas = joint > 0 ? (to.value - from.value) / joint : null;
  const far = sigmas !== null && Math.abs(sigmas) > 2;
  const text =
    sigmas !== null
      ? `${sigmas > 0 ? "+" : ""}${fixed(sigmas, 1)}σ`
      : from.value === 0
        ? ""
        : `${to.value > from.value ? "+" : ""}${fixed(100 * (to.value / from.value - 1), 0)}%`;
  return (
    <Text span size="xs" ml={6} c={far ? "var(--page-warn)" : "var(--page-quiet)"}>
      {text}
    </Text>
  );
}

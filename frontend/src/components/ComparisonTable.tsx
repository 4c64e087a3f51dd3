import { Text } from "@mantine/core";
import type { Comparison, ComparisonRow } from "../api/types";
import { fixed, withError } from "../lib/format";
import { DataTable, type Column } from "./DataTable";
import { DerivativeName } from "./DerivativeName";

/** The same derivatives as the bars, as numbers. */
export function ComparisonTable({ sources, rows }: Pick<Comparison, "sources" | "rows">) {
  const columns: Column<ComparisonRow>[] = [
    { key: "name", header: "Derivative", render: (row) => <DerivativeName name={row.name} /> },
    {
      key: "difference",
      header: (
        <span title="Largest difference between two runs, in their joint σ">Largest diff.</span>
      ),
      unit: "σ",
      numeric: true,
      render: (row) => fixed(row.max_difference_sigma, 1),
    },
    {
      key: "consistent",
      header: "Consistent",
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
                ? "All pairs of runs agree within 2σ"
                : "At least one pair of runs differs by more than 2σ"
            }
          >
            {row.consistent ? "yes" : "no"}
          </Text>
        ),
    },
    ...sources.map((source, place): Column<ComparisonRow> => ({
      key: source.key,
      header: source.label,
      numeric: true,
      render: (row) => {
        const cell = row.values[place];
        if (cell == null) return <span className="quiet">–</span>;
        const { value, error } = withError(cell.value, cell.std_error);
        return (
          <span style={{ whiteSpace: "nowrap" }}>
            {value}
            {cell.std_error != null && <span className="quiet"> ± {error}</span>}
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

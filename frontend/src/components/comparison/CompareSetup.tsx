import type { Comparison } from "../../api/types";
import type { CompareTabProps } from "./CompareDerivatives";
import { DataTable, type Column } from "../controls/DataTable";
import { Empty } from "../display/Empty";
import { Section } from "../display/Section";

type Row = Comparison["setup"][number];

/** Settings in which the compared runs differ. */
export function CompareSetup({ comparison }: CompareTabProps) {
  const columns: Column<Row>[] = [
    { key: "name", header: "Setting", render: (row) => row.name },
    ...comparison.sources.flatMap((source, index): Column<Row>[] =>
      source.kind === "prediction"
        ? []
        : [{ key: source.key, header: source.label, render: (row) => row.values[index] ?? "" }],
    ),
  ];
  return (
    <Section title="Setup differences" note="Settings common to all runs are omitted">
      {comparison.setup.length === 0 ? (
        <Empty title="Identical setup" />
      ) : (
        <DataTable
          label="Settings that differ"
          testId="setup-table"
          columns={columns}
          rows={comparison.setup}
          rowKey={(row) => row.name}
        />
      )}
    </Section>
  );
}

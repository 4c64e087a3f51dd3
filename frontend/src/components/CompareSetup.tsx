import type { Comparison } from "../api/types";
import type { CompareTabProps } from "./CompareDerivatives";
import { DataTable, type Column } from "./DataTable";
import { Empty } from "./Empty";
import { Section } from "./Section";

type Row = Comparison["setup"][number];

/** The choices in which the compared runs differ, and only these. */
export function CompareSetup({ comparison }: CompareTabProps) {
  const columns: Column<Row>[] = [
    { key: "name", header: "Choice", render: (row) => row.name },
    ...comparison.sources.flatMap((source, place): Column<Row>[] =>
      source.kind === "prediction"
        ? []
        : [{ key: source.key, header: source.label, render: (row) => row.values[place] ?? "" }],
    ),
  ];
  return (
    <Section title="What was set up otherwise" note="Choices that all runs share are left out">
      {comparison.setup.length === 0 ? (
        <Empty title="The runs were set up alike" />
      ) : (
        <DataTable
          label="Choices in which the runs differ"
          testId="setup-table"
          columns={columns}
          rows={comparison.setup}
          rowKey={(row) => row.name}
        />
      )}
    </Section>
  );
}

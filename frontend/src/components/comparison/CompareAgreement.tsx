import { Stack } from "@mantine/core";
import type { ComparisonRow, Pair } from "../../api/types";
import { fixed, significant } from "../../lib/text/format";
import type { CompareTabProps } from "./CompareDerivatives";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { DerivativeSelect } from "../controls/DerivativeSelect";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { Section } from "../display/Section";

/** Agreement of the sources: forest plot, pairs of sources, scatter by derivative. */
export function CompareAgreement({ comparison, view, onChange, onRun }: CompareTabProps) {
  const names = comparison.rows.map((row) => row.name);
  const name = names.find((one) => one === view.derivative) ?? names[0];
  const labels = new Map(comparison.sources.map((source) => [source.key, source.label]));
  const judged = comparison.rows.filter((row) => row.chi_square !== null);
  return (
    <Stack gap="md" style={{ minWidth: 0 }}>
      <Section
        title="Forest plot"
        note="Values with ±2σ; the band is the weighted mean of the runs with ±2σ"
        actions={
          <DerivativeSelect
            names={names}
            value={name}
            onChange={(derivative) => {
              onChange({ derivative });
            }}
          />
        }
      >
        {name !== undefined && (
          <Figure
            kind="forest"
            params={{ run_ids: view.runs, prediction_ids: view.predictions, name }}
            onPick={onRun}
          />
        )}
      </Section>
      <Section
        title="Pairs of sources"
        note="Differences in σ of the difference, in view of the errors that two runs share; expected value 1"
      >
        {comparison.pairs.length === 0 ? (
          <Empty title="No pairs of sources">
            Select two sources with standard errors for the same derivative.
          </Empty>
        ) : (
          <DataTable
            label="Agreement of pairs of sources"
            testId="pairs-table"
            maxHeight={420}
            columns={pairColumns(labels)}
            rows={comparison.pairs}
            rowKey={(pair) => `${pair.first} ${pair.second}`}
            isSelected={(pair) => pair.probability < 0.05}
          />
        )}
      </Section>
      {judged.length > 0 && (
        <Section
          title="Scatter by derivative"
          note="Scatter of the runs about their weighted mean; improbable values are marked"
        >
          <DataTable
            label="Scatter by derivative"
            testId="scatter-table"
            maxHeight={420}
            columns={SCATTER}
            rows={judged}
            rowKey={(row) => row.name}
            isSelected={(row) => (row.probability ?? 1) < 0.05}
          />
        </Section>
      )}
    </Stack>
  );
}

const pairColumns = (labels: ReadonlyMap<string, string>): Column<Pair>[] => [
  { key: "first", header: "Source", render: (pair) => labels.get(pair.first) },
  { key: "second", header: "against", render: (pair) => labels.get(pair.second) },
  { key: "n", header: "Derivatives", numeric: true, render: (pair) => pair.n },
  numeric("rms", "rms diff.", (pair) => fixed(pair.rms_sigma, 2), "σ"),
  { key: "chi", header: "χ²", numeric: true, render: (pair) => fixed(pair.chi_square, 1) },
  {
    key: "p",
    header: <span title="Probability of a larger χ² by chance">P</span>,
    numeric: true,
    render: (pair) => significant(pair.probability, 2),
  },
  {
    key: "worst",
    header: "Largest difference in",
    render: (pair) => <DerivativeName name={pair.worst} />,
  },
  numeric("by", "by", (pair) => fixed(pair.worst_sigma, 1), "σ"),
];

const SCATTER: Column<ComparisonRow>[] = [
  { key: "name", header: "Derivative", render: (row) => <DerivativeName name={row.name} /> },
  numeric("mean", "Weighted mean", (row) => significant(row.mean, 4)),
  { key: "error", header: "σ", numeric: true, render: (row) => significant(row.mean_std_error, 2) },
  { key: "chi", header: "χ²", numeric: true, render: (row) => fixed(row.chi_square, 1) },
  {
    key: "p",
    header: <span title="Probability of a larger scatter by chance">P</span>,
    numeric: true,
    render: (row) => significant(row.probability, 2),
  },
  numeric("largest", "Largest diff.", (row) => fixed(row.max_difference_sigma, 1), "σ"),
];

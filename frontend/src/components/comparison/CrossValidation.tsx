import { Alert, Stack } from "@mantine/core";
import { storedResult, type AnalysisQuery } from "../../api/storedResult";
import type { CrossValidationSummary, ValidatedOutput } from "../../api/types";
import { useStoredResult } from "../../api/useStoredResult";
import { fixed } from "../../lib/text/format";
import { ComputeButton } from "../controls/ComputeButton";
import { DataTable, type Column } from "../controls/DataTable";
import { Figure } from "../figures/Figure";
import { JobWait } from "../jobs/JobWait";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";

const COLUMNS: Column<ValidatedOutput>[] = [
  { key: "output", header: "Output", render: (row) => row.output },
  { key: "r2", header: "R²", numeric: true, render: (row) => fixed(row.r_squared, 3) },
  {
    key: "fitted-r2",
    header: "R² of the run",
    numeric: true,
    render: (row) => fixed(row.fitted_r_squared, 3),
  },
  { key: "theil", header: "Theil", numeric: true, render: (row) => fixed(row.theil, 3) },
  {
    key: "fitted-theil",
    header: "Theil of the run",
    numeric: true,
    render: (row) => fixed(row.fitted_theil, 3),
  },
];

interface Props {
  query: AnalysisQuery<"/api/v1/cross-validations">;
  output: string | undefined;
}

/** Refits of a run without held-out data, and their predictions of these. */
export function CrossValidation({ query, output }: Props) {
  const { result, jobId, error, onEnd, compute } = useStoredResult(
    storedResult("/api/v1/cross-validations", { query }),
  );
  const shown = result.data?.outputs.some((one) => one.output === output) ? output : undefined;
  return (
    <Section
      title="Cross-validation"
      note={`Run ${query.run_id}, fitted again with its settings; outputs predicted from measured inputs`}
    >
      <Stack gap="md">
        {error !== null && <ProblemAlert error={error} />}
        <ComputeButton compute={compute} />
        {jobId !== undefined && <JobWait key={jobId} id={jobId} onEnd={onEnd} />}
        {compute === undefined && jobId === undefined && error === null && (
          <Loaded query={result} rows={6}>
            {(data) => <Summary data={data} />}
          </Loaded>
        )}
        {result.data !== undefined && (
          <>
            <Figure
              kind="held-out"
              title="Measured and predicted data held out"
              params={{ ...query, outputs: shown }}
            />
            <Figure
              kind="held-out-residual"
              title="Residuals of the data held out"
              params={{ ...query }}
            />
          </>
        )}
      </Stack>
    </Section>
  );
}

function Summary({ data }: { data: CrossValidationSummary }) {
  return (
    <>
      <Alert
        variant="light"
        role="status"
        title={data.sentence}
        styles={{ title: { color: "var(--mantine-color-text)" } }}
        data-testid="cross-validation-result"
      >
        {data.refits.map((one) => `${one.name}: R² ${fixed(one.r_squared, 3)}`).join(", ")}
      </Alert>
      <DataTable
        label="Outputs at the data held out"
        testId="cross-validation-outputs"
        columns={COLUMNS}
        rows={data.outputs}
        rowKey={(row) => `${row.maneuver_id} ${row.output}`}
        maxHeight={360}
      />
    </>
  );
}

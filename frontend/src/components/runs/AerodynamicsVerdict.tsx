import { Alert, Button, Stack } from "@mantine/core";
import { useState } from "react";
import { storedResult } from "../../api/storedResult";
import type { AerodynamicsComparison } from "../../api/types";
import { fixed, significant } from "../../lib/text/format";
import { ComputedResult } from "../display/ComputedResult";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { UnitName, WithInterval } from "../display/Quantity";
import { Section } from "../display/Section";

type Fit = AerodynamicsComparison["fits"][number];

const COLUMNS: Column<Fit>[] = [
  { key: "model", header: "Derivatives", render: (fit) => fit.aerodynamics },
  numeric("held-out", "Held out, per frequency", (fit) => fixed(fit.held_out, 2)),
  numeric("cost", "Cost of all data", (fit) => significant(fit.cost, 6)),
  numeric("r2", "Lowest R²", (fit) => fixed(fit.smallest_r_squared, 3)),
  numeric("lag", "p of a lag", (fit) => significant(fit.lag_p, 2)),
  {
    key: "flutter",
    header: "Flutter ±2σ",
    unit: <UnitName unit="m/s" />,
    numeric: true,
    render: (fit) =>
      fit.flutter_m_s === null ? (
        "none"
      ) : (
        <WithInterval value={fit.flutter_m_s} std={fit.flutter_std_m_s} unit="m/s" decimals={2} />
      ),
  },
];

const COLORS = { shaped: "yellow", "quasi-steady": "green", "not decided": "gray" } as const;

/** Verdict between quasi-steady and shaped derivatives for the data of a run. */
export function AerodynamicsVerdict({ runId }: { runId: number }) {
  const [requested, setRequested] = useState(false);
  return (
    <Section
      title="Aerodynamics"
      note="Quasi-steady against shaped derivatives: both fitted by output error to two of three frequencies of each input, and to all"
    >
      {requested ? (
        <ComputedResult
          options={storedResult("/api/v1/aerodynamics-comparisons", { query: { run_id: runId } })}
        >
          {(data) => <Verdict data={data} />}
        </ComputedResult>
      ) : (
        <Button
          size="xs"
          variant="default"
          data-testid="compare-aerodynamics"
          onClick={() => {
            setRequested(true);
          }}
        >
          Compare aerodynamics
        </Button>
      )}
    </Section>
  );
}

function Verdict({ data }: { data: AerodynamicsComparison }) {
  return (
    <Stack gap="sm">
      <Alert
        color={COLORS[data.verdict]}
        variant="light"
        role="status"
        title={`Verdict: ${data.verdict}`}
        data-testid="aerodynamics-verdict"
      >
        {data.sentence}
      </Alert>
      <DataTable
        label={`${data.n_held_out} of ${data.n_frequencies} frequencies held out, up to k = ${fixed(data.highest_k, 2)}`}
        columns={COLUMNS}
        rows={data.fits}
        rowKey={(fit) => fit.aerodynamics}
      />
    </Stack>
  );
}

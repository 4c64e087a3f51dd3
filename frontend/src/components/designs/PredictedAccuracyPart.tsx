import { predictedAccuracyResult } from "../../api/queries";
import type { Design, ExpectedError, ExpectedMode, ExpectedSummary } from "../../api/types";
import type { overFrequency } from "../../lib/figures/band";
import { fixed, relativeError, withError } from "../../lib/text/format";
import { ComputedResult } from "../display/ComputedResult";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { Figure } from "../figures/Figure";
import { quantity } from "../display/Quantity";
import { Section } from "../display/Section";

const EXPECTED_COLUMNS: Column<ExpectedError>[] = [
  { key: "name", header: "Derivative", render: (row) => <DerivativeName name={row.name} /> },
  numeric("value", "Value of the run", (row) => withError(row.value, row.std_error).value),
  numeric("error", "Predicted σ", (row) => withError(row.value, row.std_error).error),
  {
    key: "relative",
    header: "Relative σ",
    unit: "%",
    numeric: true,
    render: (row) => fixed(relativeError(row.value, row.std_error), 1),
  },
];

const MODE_COLUMNS: Column<ExpectedMode>[] = [
  { key: "name", header: "Mode", render: (mode) => mode.name },
  quantity("frequency", "Frequency", (mode) => mode.frequency_hz, "Hz", 2),
  { key: "damping", header: "ζ", numeric: true, render: (mode) => fixed(mode.damping, 3) },
  numeric("harmonics", "Harmonics in half-power band", (mode) => mode.n_harmonics),
  { key: "output", header: "Best output", render: (mode) => mode.output ?? "not excited" },
  {
    key: "signal",
    header: "Signal-to-noise ratio",
    unit: "dB",
    numeric: true,
    render: (mode) =>
      fixed(mode.signal_to_noise === null ? null : 20 * Math.log10(mode.signal_to_noise), 1),
  },
];

interface Row {
  name: string;
  values: number[];
}

const correlationColumns = (surfaces: string[]): Column<Row>[] => [
  { key: "name", header: "Deflection", render: (row) => row.name },
  ...surfaces.map((name, index) => ({
    key: name,
    header: name,
    numeric: true,
    render: (row: Row) => fixed(row.values[index] ?? null, 3),
  })),
];

interface Props {
  design: Design;
  level: number;
  run: number;
  /** Zoom and cursor shared by figures over frequency. */
  shared: ReturnType<typeof overFrequency>;
}

/** Predicted accuracy of a run's derivatives: errors, signals, correlation, information. */
export function PredictedAccuracyPart({ design, level, run, shared }: Props) {
  const params = { design_id: design.id, run_id: run, level };
  return (
    <ComputedResult options={predictedAccuracyResult(design.id, level, run)} rows={12}>
      {({ errors, response }) => (
        <>
          <Section
            title="Modes"
            note="Best output near each identified frequency; unmodelled response counts as noise"
          >
            <DataTable
              label="Modes"
              testId="expected-modes"
              columns={MODE_COLUMNS}
              rows={response.modes}
              rowKey={(mode) => mode.name}
            />
          </Section>
          <div className="panel" style={{ padding: 12 }}>
            <Figure
              {...shared}
              kind="design-signal"
              title="Signal-to-noise ratio by harmonic"
              params={params}
            />
          </div>
          <div className="panel" style={{ padding: 12 }}>
            <Figure
              {...shared}
              kind="design-information"
              title="Information by harmonic, in parameters"
              params={params}
            />
          </div>
          <Section
            title="Correlation of the deflections"
            note="Over one period, with feedback and actuators; limit 0.9"
          >
            <Correlation summary={response} />
          </Section>
          <Section
            title="Standard errors"
            note="For the model, condition and noise of the run; unmodelled response scales with the amplitude"
          >
            <p className="quiet">
              Surfaces follow {errors.surfaces}.
              {errors.harmonics_outside_band > 0 &&
                ` ${errors.harmonics_outside_band} harmonics lie outside the band of the run; the values at its limits are used there.`}
              {errors.omitted.length > 0 &&
                ` The model of the run has no input ${errors.omitted.join(", ")}: the harmonics of throttles are not part of the prediction.`}
              {errors.adequacy === "suspect" &&
                " The run is suspect: predicted σ is wider by its model error."}
            </p>
            <DataTable
              label="Predicted standard errors"
              testId="expected-errors"
              columns={EXPECTED_COLUMNS}
              rows={errors.items}
              rowKey={(row) => row.name}
              maxHeight={560}
            />
          </Section>
        </>
      )}
    </ComputedResult>
  );
}

function Correlation({ summary }: { summary: ExpectedSummary }) {
  return (
    <DataTable
      label="Correlation of the deflections"
      testId="expected-correlation"
      columns={correlationColumns(summary.surfaces)}
      rows={summary.surfaces.map((name, row) => ({ name, values: summary.correlation[row] ?? [] }))}
      rowKey={(row) => row.name}
    />
  );
}

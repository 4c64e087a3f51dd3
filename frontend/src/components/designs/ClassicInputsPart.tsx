import { Stack } from "@mantine/core";
import { storedResult } from "../../api/storedResult";
import type { ComparedInput, Design, InputComparison } from "../../api/types";
import { fixed } from "../../lib/text/format";
import { ComputedResult } from "../display/ComputedResult";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { quantity } from "../display/Quantity";

const RADIAN2 = (180 / Math.PI) ** 2;

const INPUTS: Column<ComparedInput>[] = [
  { key: "kind", header: "Input", render: (row) => row.kind },
  numeric("pulse", "Pulse", (row) => (row.pulse_s === null ? "" : fixed(row.pulse_s, 3)), "s"),
  quantity("deflection", "Peak deflection", (row) => row.deflection, "rad", 4),
  numeric("load", "Load factor", (row) => fixed(row.load_factor, 3), "g"),
  numeric("energy", "Energy of the commands", (row) => fixed(row.energy * RADIAN2, 1), "deg² s"),
  { key: "lacking", header: "", render: (row) => row.lacking },
];

interface Row {
  name: string;
  value: number;
  errors: (number | undefined)[];
}

const errorColumns = (found: InputComparison): Column<Row>[] => [
  { key: "name", header: "Derivative", render: (row) => <DerivativeName name={row.name} /> },
  {
    key: "multisine",
    header: "σ, multisine",
    unit: "%",
    numeric: true,
    render: (row) => share(row.errors[0], Math.abs(row.value), 100, 1),
  },
  ...found.inputs.slice(1).map((input, index) => ({
    key: input.kind,
    header: `${input.kind} over multisine`,
    numeric: true,
    render: (row: Row) => share(row.errors[index + 1], row.errors[0], 1, 2),
  })),
];

const share = (
  value: number | undefined,
  by: number | undefined,
  factor: number,
  digits: number,
) =>
  value === undefined || by === undefined || by === 0 ? "" : fixed((factor * value) / by, digits);

/** Predicted accuracy of doublets, 3-2-1-1s and sweeps of the same duration and limits. */
export function ClassicInputsPart({
  design,
  level,
  run,
}: {
  design: Design;
  level: number;
  run: number;
}) {
  return (
    <ComputedResult
      options={storedResult("/api/v1/designs/{design_id}/classic-inputs", {
        path: { design_id: design.id },
        query: { run_id: run, level },
      })}
      rows={12}
    >
      {(comparison) => (
        <Stack gap="sm">
          <DataTable
            label="Compared inputs"
            testId="classic-inputs"
            columns={INPUTS}
            rows={comparison.inputs}
            rowKey={(row) => row.kind}
          />
          <DataTable
            label="Standard errors by input"
            testId="classic-errors"
            columns={errorColumns(comparison)}
            rows={comparison.names.map((name, k) => ({
              name,
              value: comparison.values[k] ?? 0,
              errors: comparison.inputs.map((input) => input.std_errors[k]),
            }))}
            rowKey={(row) => row.name}
            maxHeight={560}
          />
        </Stack>
      )}
    </ComputedResult>
  );
}

import { Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { classicInputsQuery } from "../api/queries";
import type { ComparedInput, Design, InputComparison } from "../api/types";
import { degrees, fixed } from "../lib/format";
import { DataTable, type Column } from "./DataTable";
import { DerivativeName } from "./DerivativeName";
import { Loaded } from "./Loaded";

const RADIAN2 = (180 / Math.PI) ** 2;

const INPUTS: Column<ComparedInput>[] = [
  { key: "kind", header: "Input", render: (row) => row.kind },
  {
    key: "pulse",
    header: "Pulse",
    unit: "s",
    numeric: true,
    render: (row) => (row.pulse_s === null ? "" : fixed(row.pulse_s, 3)),
  },
  {
    key: "deflection",
    header: "Peak deflection",
    unit: "deg",
    numeric: true,
    render: (row) => fixed(degrees(row.deflection), 2),
  },
  {
    key: "load",
    header: "Load factor",
    unit: "g",
    numeric: true,
    render: (row) => fixed(row.load_factor, 3),
  },
  {
    key: "energy",
    header: "Energy of the commands",
    unit: "deg² s",
    numeric: true,
    render: (row) => fixed(row.energy * RADIAN2, 1),
  },
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
  ...found.inputs.slice(1).map((input, place) => ({
    key: input.kind,
    header: `${input.kind} over multisine`,
    numeric: true,
    render: (row: Row) => share(row.errors[place + 1], row.errors[0], 1, 2),
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
  const found = useQuery(classicInputsQuery(design.id, level, run));
  return (
    <Loaded query={found} rows={12}>
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
    </Loaded>
  );
}

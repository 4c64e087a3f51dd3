import { Text, UnstyledButton } from "@mantine/core";
import type { ModelAdequacy, Parameter } from "../../api/types";
import { fixed, withError } from "../../lib/text/format";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { Empty } from "../display/Empty";
import type { RunTabProps } from "./FitTab";

type Sensor = ModelAdequacy["without_sensors"][number];

interface Row {
  parameter: Parameter;
  value: number | null;
  stdError: number | null;
  difference: number | null;
}

const product = (a: number | null | undefined, b: number | null | undefined) =>
  a == null || b == null ? null : a * b;

const sizeOf = (row: Row) => Math.abs(row.difference ?? -1);

const COLUMNS: Column<Row>[] = [
  {
    key: "name",
    header: "Parameter",
    render: ({ parameter }) => <DerivativeName name={parameter.name} />,
  },
  numeric("with", "With", (row) => withError(row.parameter.value, row.parameter.std_error).value),
  numeric(
    "with-error",
    "σ",
    (row) => withError(row.parameter.value, row.parameter.std_error).error,
  ),
  numeric("without", "Without", (row) =>
    row.value === null ? "not determined" : withError(row.value, row.stdError).value,
  ),
  numeric("without-error", "σ", (row) => withError(row.value ?? 0, row.stdError).error),
  numeric(
    "difference",
    <span title="In standard errors of the difference">Difference</span>,
    (row) => fixed(row.difference, 1),
    "σ",
  ),
];

/** The estimate without each sensor, by one step from the optimum. */
export function SensorsTab({ run, view, onChange }: RunTabProps) {
  const sensors = run.adequacy?.without_sensors ?? [];
  const selected = sensors.find((one) => one.output === view.output) ?? sensors[0];
  if (selected === undefined) {
    return (
      <Empty title="No estimates without a sensor">
        Runs that were not tested for remaining model error, and runs of earlier releases, have
        none.
      </Empty>
    );
  }
  const rows = (sensor: Sensor): Row[] =>
    run.parameters
      .map((parameter, k) => ({
        parameter,
        value: sensor.values[k] ?? null,
        stdError: product(parameter.std_error, sensor.std_ratios[k]),
        difference: sensor.differences[k] ?? null,
      }))
      .sort((a, b) => sizeOf(b) - sizeOf(a));
  const test = (output: string) =>
    run.adequacy?.tests.find(
      (one) => one.hypothesis === "sensor consistency" && one.subject === output,
    );
  const columns: Column<Sensor>[] = [
    {
      key: "output",
      header: "Without",
      render: ({ output }) => (
        <UnstyledButton
          fz="sm"
          className="link"
          aria-pressed={output === selected.output}
          onClick={() => {
            onChange({ output });
          }}
        >
          {output}
        </UnstyledButton>
      ),
    },
    {
      key: "parameter",
      header: "Largest difference",
      render: (one) => {
        const row = rows(one)[0];
        return row === undefined ? "–" : <DerivativeName name={row.parameter.name} />;
      },
    },
    numeric("size", "", (one) => fixed(rows(one)[0]?.difference, 1), "σ"),
    {
      key: "rejects",
      header: "",
      render: ({ output }) =>
        test(output)?.rejects === true && (
          <Text span size="xs" c="var(--page-warn)" title={test(output)?.meaning}>
            inconsistent
          </Text>
        ),
    },
  ];
  return (
    <>
      <Text size="sm" mb="sm">
        What the estimate would be without one sensor, by one Gauss-Newton step. Sensors of a
        correct model differ by their noise only.
      </Text>
      <div className="split split-wide">
        <div className="panel">
          <DataTable
            label="Sensors"
            testId="sensors"
            rows={[...sensors]}
            rowKey={(one) => one.output}
            isSelected={(one) => one.output === selected.output}
            columns={columns}
          />
        </div>
        <div className="panel">
          <DataTable
            label={`Estimates with and without ${selected.output}`}
            testId="without-sensor"
            rows={rows(selected)}
            rowKey={(row) => row.parameter.name}
            columns={COLUMNS}
          />
        </div>
      </div>
    </>
  );
}

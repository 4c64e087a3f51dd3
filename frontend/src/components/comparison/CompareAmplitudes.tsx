import { Alert, Button, List, Stack, Text } from "@mantine/core";
import { storedResult } from "../../api/storedResult";
import type { AmplitudeComparison } from "../../api/types";
import { fixed, significant, withError } from "../../lib/text/format";
import type { CompareTabProps } from "./CompareDerivatives";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { ComputedResult } from "../display/ComputedResult";
import { DerivativeName } from "../display/DerivativeName";
import { Empty } from "../display/Empty";
import { Sentence } from "../display/Quantity";
import { Section } from "../display/Section";

type Test = AmplitudeComparison["tests"][number];
type Row = Test & { quantity: Test["quantities"][number]; isFirst: boolean };

/** Whether one linear model holds at the amplitudes of the runs, by derivative, mode and input. */
export function CompareAmplitudes({ view, onChange }: CompareTabProps) {
  const runs = view.runs ?? [];
  return (
    <Section
      title="Amplitude dependence"
      note="Fits of all levels with the same weights, by which a linear aircraft has the same values at every amplitude; ±2σ due to noise, p in view of the number of tests"
    >
      {view.amplitudes === true && runs.length > 1 ? (
        <ComputedResult
          options={storedResult("/api/v1/amplitude-comparisons", {
            query: { run_ids: runs.join(",") },
          })}
        >
          {(data) => <Tests data={data} />}
        </ComputedResult>
      ) : (
        <Empty title="Not compared">
          Select output-error runs of maneuvers with one multisine at several amplitudes.
          <Button
            variant="default"
            size="compact-sm"
            disabled={runs.length < 2}
            onClick={() => {
              onChange({ amplitudes: true });
            }}
          >
            Compare amplitudes
          </Button>
        </Empty>
      )}
    </Section>
  );
}

function Tests({ data }: { data: AmplitudeComparison }) {
  const rejecting = data.tests.filter((one) => one.rejects);
  return (
    <Stack gap="sm">
      <Alert
        color={data.is_linear ? "green" : "yellow"}
        variant="light"
        role="status"
        data-testid="amplitude-comparison"
      >
        <Text size="sm">{data.sentence}</Text>
        {rejecting.length > 0 && (
          <List size="sm" mt="xs">
            {rejecting.map((one) => (
              <List.Item key={`${one.subject} ${one.name}`}>
                {one.subject === "derivative" ? <DerivativeName name={one.name} /> : one.name}
                {": "}
                <Sentence text={one.meaning} />
              </List.Item>
            ))}
          </List>
        )}
      </Alert>
      <DataTable
        label="Values over amplitude"
        testId="amplitude-table"
        maxHeight={640}
        columns={columnsOf(data)}
        rows={data.tests.flatMap((one) =>
          one.quantities.map((quantity, index) => ({ ...one, quantity, isFirst: index === 0 })),
        )}
        rowKey={(row) => `${row.subject} ${row.name} ${row.quantity.name}`}
        isSelected={(row) => row.rejects}
      />
    </Stack>
  );
}

/** A value with two standard errors; ratios in percent. */
function interval(value: number, std: number): string {
  const shown = withError(value, std);
  return `${shown.value} ± ${withError(2 * std, std).value}`;
}

const columnsOf = (data: AmplitudeComparison): Column<Row>[] => [
  {
    key: "name",
    header: "Quantity",
    render: (row) =>
      row.subject === "derivative" ? (
        <DerivativeName name={row.name} />
      ) : (
        `${row.name}, ${row.quantity.name}${row.quantity.unit === "1" ? "" : ` [${row.quantity.unit}]`}`
      ),
  },
  ...data.levels.map((level, index) =>
    numeric<Row>(
      `level-${String(index)}`,
      <span title={level.label}>{significant((180 / Math.PI) * level.amplitude_rad, 3)}° rms</span>,
      (row) => {
        const [value, std] = [row.quantity.values[index], row.quantity.std_errors[index]];
        return value === undefined || std === undefined ? "" : interval(value, std);
      },
    ),
  ),
  numeric(
    "change",
    <span title="At the largest amplitude, from the mean of the smaller ones">Change</span>,
    (row) => interval(row.quantity.change, row.quantity.change_std_error),
  ),
  numeric("chi", <span title="With its degrees of freedom">χ²</span>, (row) =>
    row.isFirst ? `${fixed(row.chi_square, 1)} (${String(row.degrees_of_freedom)})` : "",
  ),
  numeric("p", <span title="In view of the number of tests (Holm)">p</span>, (row) =>
    row.isFirst ? significant(row.adjusted_p, 2) : "",
  ),
];

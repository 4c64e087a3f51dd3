import { Group, SegmentedControl, Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { observabilityQuery } from "../../api/queries";
import type { Observability } from "../../api/types";
import { fixed, percent } from "../../lib/text/format";
import { SYMMETRIES } from "../../views";
import { DataTable, type Column } from "../controls/DataTable";
import { Loaded } from "../display/Loaded";
import { NumberField } from "../controls/NumberField";
import { Section } from "../display/Section";
import type { TableProps } from "./tables";

/** Modal observability of the sensors, and candidate accelerometer positions. */
export function ModeSensorsTab({ table, view, onChange }: TableProps) {
  const symmetry = view.symmetry ?? "symmetric";
  const query = {
    fuel: (view.fuel ?? 50) / 100,
    symmetry,
    up_to_hz: view.up_to ?? 20,
  };
  const observability = useQuery(observabilityQuery(table.id, query));
  return (
    <Stack gap="md">
      <Group align="end">
        <SegmentedControl
          aria-label="Symmetry"
          data={[...SYMMETRIES]}
          value={symmetry}
          onChange={(value) => {
            onChange({ symmetry: SYMMETRIES.find((one) => one === value) });
          }}
        />
        <NumberField
          label="Up to"
          unit="Hz"
          w={110}
          min={1}
          value={view.up_to ?? 20}
          onChange={(up_to) => {
            onChange({ up_to });
          }}
        />
      </Group>
      <Loaded query={observability} rows={10}>
        {(data) => <Result result={data} />}
      </Loaded>
    </Stack>
  );
}

type Row = Observability["rows"][number];

function Result({ result }: { result: Observability }) {
  const columns: Column<Row>[] = [
    { key: "sensor", header: "Sensor", render: (row) => row.sensor },
    { key: "kind", header: "Kind", render: (row) => `${row.kind} ${row.axis}` },
    ...result.names.map((name, index): Column<Row> => {
      const error = result.std_error[index];
      return {
        key: name,
        header: name,
        numeric: true,
        unit: error == null ? "not identifiable" : `σ ×${error.toPrecision(2)}`,
        render: (row) => <Share value={row.share[index] ?? null} />,
      };
    }),
  ];
  return (
    <>
      <Section
        title="Observability by sensor"
        note="Fraction of the largest motion of its kind in each mode; σ is the standard error of the modal acceleration relative to the best mode"
      >
        <DataTable
          label="Observability"
          testId="observability"
          columns={columns}
          rows={result.rows}
          rowKey={(row) => row.sensor}
          maxHeight={560}
        />
      </Section>
      <Section
        title="Candidate accelerometer positions"
        note="Ranked by information gain on all modes; at least 15 % of the span apart"
      >
        <DataTable
          label="Candidates"
          testId="candidates"
          columns={[
            { key: "axis", header: "Axis", render: (row) => row.axis },
            {
              key: "location",
              header: "Position: aft, right, up",
              unit: "m",
              render: (row) => row.location_m.map((value) => fixed(value, 2)).join(", "),
            },
            { key: "helps", header: "Best for mode", render: (row) => row.helps },
            {
              key: "left",
              header: "Standard error with sensor",
              unit: "%",
              numeric: true,
              render: (row) => percent(row.shrinks_to),
            },
            {
              key: "gain",
              header: "Information",
              numeric: true,
              render: (row) => fixed(row.gain, 2),
            },
          ]}
          rows={result.candidates}
          rowKey={(row) => `${String(row.node)} ${row.axis}`}
        />
      </Section>
    </>
  );
}

function Share({ value }: { value: number | null }) {
  if (value === null) return <>–</>;
  const strength = Math.round(70 * Math.min(1, value));
  return (
    <span
      style={{
        background: `color-mix(in srgb, light-dark(var(--mantine-color-blue-5), var(--mantine-color-blue-9)) ${String(strength)}%, transparent)`,
        padding: "1px 6px",
        borderRadius: 3,
      }}
    >
      {percent(value)}
    </span>
  );
}

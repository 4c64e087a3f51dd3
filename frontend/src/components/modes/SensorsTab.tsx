import { Group, NumberInput, SegmentedControl, Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { observabilityQuery } from "../../api/queries";
import type { Observability } from "../../api/types";
import { fixed, percent } from "../../lib/format";
import { SYMMETRIES } from "../../views";
import { DataTable, type Column } from "../DataTable";
import { Loaded } from "../Loaded";
import { Section } from "../Section";
import type { TableProps } from "./tables";

/** Which sensor sees which mode, and where a further accelerometer would help most. */
export function SensorsTab({ table, view, onChange }: TableProps) {
  const symmetry = view.symmetry ?? "symmetric";
  const question = {
    fuel: (view.fuel ?? 50) / 100,
    symmetry,
    up_to_hz: view.up_to ?? 20,
  };
  const told = useQuery(observabilityQuery(table.id, question));
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
        <NumberInput
          label="Up to [Hz]"
          w={110}
          min={1}
          value={view.up_to ?? 20}
          onChange={(value) => {
            onChange({ up_to: typeof value === "number" ? value : undefined });
          }}
        />
      </Group>
      <Loaded query={told} rows={10}>
        {(data) => <Told told={data} />}
      </Loaded>
    </Stack>
  );
}

type Row = Observability["rows"][number];

function Told({ told }: { told: Observability }) {
  const columns: Column<Row>[] = [
    { key: "sensor", header: "Sensor", render: (row) => row.sensor },
    { key: "kind", header: "Kind", render: (row) => `${row.kind} ${row.axis}` },
    ...told.names.map((name, place): Column<Row> => {
      const error = told.std_error[place];
      return {
        key: name,
        header: name,
        numeric: true,
        unit: error == null ? "not told apart" : `σ ×${error.toPrecision(2)}`,
        render: (row) => <Share value={row.share[place] ?? null} />,
      };
    }),
  ];
  return (
    <>
      <Section
        title="What each sensor sees"
        note="Share of the largest motion of its kind in each mode; σ is the standard error of the mode's acceleration relative to the best known mode's"
      >
        <DataTable
          label="Observability"
          testId="observability"
          columns={columns}
          rows={told.rows}
          rowKey={(row) => row.sensor}
          maxHeight={560}
        />
      </Section>
      <Section
        title="Where a further accelerometer would help most"
        note="By the growth of the information on all modes, places at least 15 % of the span apart"
      >
        <DataTable
          label="Candidates"
          testId="candidates"
          columns={[
            { key: "axis", header: "Axis", render: (row) => row.axis },
            {
              key: "place",
              header: "Place: aft, right, up",
              unit: "m",
              render: (row) => row.place_m.map((value) => fixed(value, 2)).join(", "),
            },
            { key: "helps", header: "Helps most", render: (row) => row.helps },
            {
              key: "left",
              header: "Its standard error falls to",
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
          rows={told.candidates}
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

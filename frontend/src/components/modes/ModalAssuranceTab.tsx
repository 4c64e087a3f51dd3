import { Button, Select, Stack, Text, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { useUpdateModalTable } from "../../api/commands";
import { correlationQuery } from "../../api/queries";
import type { Correlation, ModalTable, PairedMode } from "../../api/types";
import { fixed, percent } from "../../lib/text/format";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Figure } from "../figures/Figure";
import { Loaded } from "../display/Loaded";
import { NumberField } from "../controls/NumberField";
import { ProblemAlert } from "../display/ProblemAlert";
import { quantity } from "../display/Quantity";
import { Section } from "../display/Section";
import { tableTitle, type TableProps } from "./tables";

/** MAC of two sources or two fuel weights, paired modes, and points of low COMAC. */
export function ModalAssuranceTab({ table, usable, view, onChange }: TableProps) {
  const comparable = usable.filter((one) => "nodes" in one.arrays || "shape" in one.arrays);
  const other = comparable.find((one) => one.id === view.other) ?? table;
  const query = {
    fuel: (view.fuel ?? 50) / 100,
    other_id: other.id,
    other_fuel: (view.other_fuel ?? view.fuel ?? 50) / 100,
  };
  const correlation = useQuery(correlationQuery(table.id, query));
  return (
    <div className="split split-early">
      <Stack gap="md">
        <Select
          label="Compared with"
          allowDeselect={false}
          data={comparable.map((one) => ({ value: String(one.id), label: tableTitle(one) }))}
          value={String(other.id)}
          onChange={(value) => {
            onChange({ other: Number(value) });
          }}
        />
        <NumberField
          label="At fuel"
          unit="%"
          min={0}
          max={100}
          value={view.other_fuel ?? view.fuel ?? 50}
          onChange={(value) => {
            onChange({ other_fuel: value });
          }}
        />
        {table.kind === "FEM" && other.kind === "GVT" && (
          <UpdateForm
            key={`${String(table.id)} ${String(other.id)}`}
            {...{ table, other }}
            onSaved={(saved) => {
              onChange({ table: saved.id });
            }}
          />
        )}
      </Stack>
      <Stack gap="md">
        <div className="panel" style={{ padding: 12 }}>
          <Figure
            kind="mac"
            title="Modal assurance criterion"
            params={{ modal_table_id: table.id, ...query }}
            height={620}
          />
        </div>
        <Loaded query={correlation} rows={8}>
          {(data) => <Result result={data} />}
        </Loaded>
      </Stack>
    </div>
  );
}

interface UpdateProps {
  table: ModalTable;
  other: ModalTable;
  onSaved: (table: ModalTable) => void;
}

/** Store the model with frequencies and damping of the test, as a new table. */
function UpdateForm({ table, other, onSaved }: UpdateProps) {
  const update = useUpdateModalTable(table.id);
  const [name, setName] = useState(`${table.name} updated`);
  return (
    <Stack gap="xs">
      <TextInput
        label="Updated model"
        description="Frequencies and damping of modes with a MAC of 0.7 or more"
        value={name}
        onChange={(event) => {
          setName(event.currentTarget.value);
        }}
      />
      <Button
        variant="default"
        loading={update.isPending}
        disabled={name.trim() === ""}
        onClick={() => {
          update.mutate({ name: name.trim(), test_ids: [other.id] }, { onSuccess: onSaved });
        }}
      >
        Update model
      </Button>
      {update.isError && <ProblemAlert error={update.error} />}
    </Stack>
  );
}

function Result({ result }: { result: Correlation }) {
  return (
    <>
      <Section title="Paired modes" note={result.notes.join(" ")}>
        <DataTable
          label="Paired modes"
          testId="paired-modes"
          columns={PAIRS}
          rows={result.pairs}
          rowKey={(row) => row.number}
          maxHeight={420}
        />
      </Section>
      {result.points.length > 0 && (
        <Section title="Points of lowest COMAC" note="COMAC over matched pairs">
          <DataTable
            label="COMAC"
            columns={[
              { key: "point", header: "Point", render: (row) => row.point },
              { key: "direction", header: "Direction", render: (row) => row.direction },
              {
                key: "comac",
                header: "COMAC",
                numeric: true,
                render: (row) => fixed(row.comac, 4),
              },
            ]}
            rows={result.points.slice(0, 12)}
            rowKey={(row) => `${row.point} ${row.direction}`}
          />
        </Section>
      )}
    </>
  );
}

const PAIRS: Column<PairedMode>[] = [
  { key: "name", header: "Mode", render: (row) => row.name },
  { key: "other", header: "Best match", render: (row) => row.other_name },
  {
    key: "mac",
    header: "MAC",
    numeric: true,
    render: (row) => (
      <Text component="span" size="sm" fw={row.mac >= 0.9 ? 600 : undefined}>
        {fixed(row.mac, 3)}
      </Text>
    ),
  },
  {
    key: "cross",
    header: "Cross-orthogonality",
    numeric: true,
    onlyIf: (row) => row.cross_orthogonality !== null,
    render: (row) => fixed(row.cross_orthogonality, 3),
  },
  quantity("hz", "Frequency", (row) => row.frequency_hz, "Hz", 3),
  quantity("other_hz", "Other", (row) => row.other_hz, "Hz", 3),
  numeric("change", "Difference", (row) => percent(row.frequency_change, 2), "%"),
  numeric("damping", "Damping", (row) => percent(row.damping, 2), "%"),
  numeric("other_damping", "Other", (row) => percent(row.other_damping, 2), "%"),
];

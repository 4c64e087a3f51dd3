import { Button, Group, Stack, Text, Textarea, TextInput } from "@mantine/core";
import { useState } from "react";
import { useRemoveThrust, useSetThrust } from "../../api/commands";
import type { Aircraft, ThrustTable } from "../../api/types";
import { fixed } from "../../lib/text/format";
import { DataTable } from "../controls/DataTable";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";

const RPM = Math.PI / 30;
const EXAMPLE = "rpm, 273, 288\n30000, 8.1, 7.9\n60000, 65, 63\n90000, 219, 213";

/** Thrust of one engine against rotation speed and total temperature, shown and edited. */
export function ThrustSection({ aircraft }: { aircraft: Aircraft }) {
  const [editing, setEditing] = useState(false);
  const { thrust } = aircraft;
  return (
    <Section
      title="Thrust"
      note={
        thrust
          ? `Of one engine, in N; channels ${thrust.engines.join(", ")}. ${thrust.source}`
          : "Without a table, thrust is the recorded thrust, or equals the drag."
      }
      actions={
        <Button
          variant="default"
          size="xs"
          aria-expanded={editing}
          data-testid="edit-thrust"
          onClick={() => {
            setEditing(!editing);
          }}
        >
          {thrust ? "Edit" : "Add a table"}
        </Button>
      }
    >
      <Stack gap="md">
        {thrust && !editing && <ThrustRows table={thrust} />}
        {editing && (
          <ThrustForm
            aircraft={aircraft}
            onDone={() => {
              setEditing(false);
            }}
          />
        )}
      </Stack>
    </Section>
  );
}

function ThrustRows({ table }: { table: ThrustTable }) {
  return (
    <div style={{ maxWidth: 640 }}>
      <DataTable
        label="Thrust"
        testId="thrust-table"
        columns={[
          {
            key: "speed",
            header: "Rotation speed",
            unit: "rpm",
            numeric: true,
            render: (row: number) => fixed((table.engine_speed_rad_s[row] ?? NaN) / RPM, 0),
          },
          ...table.total_temperature_k.map((kelvin, column) => ({
            key: `t${column}`,
            header: table.total_temperature_k.length > 1 ? `At ${fixed(kelvin, 2)} K` : "Thrust",
            unit: "N",
            numeric: true,
            render: (row: number) => fixed(table.thrust_n[row]?.[column], 1),
          })),
        ]}
        rows={table.engine_speed_rad_s.map((_, row) => row)}
        rowKey={(row) => row}
      />
    </div>
  );
}

function ThrustForm({ aircraft, onDone }: { aircraft: Aircraft; onDone: () => void }) {
  const known = aircraft.thrust;
  const save = useSetThrust();
  const remove = useRemoveThrust();
  const [text, setText] = useState(known ? asText(known) : "");
  const [engines, setEngines] = useState(known?.engines.join(", ") ?? "engine_speed");
  const [units, setUnits] = useState({ speed: "rpm", temperature: "K", thrust: "N" });
  const [source, setSource] = useState(known?.source ?? "");
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        save.mutate(
          {
            id: aircraft.id,
            table: {
              engines: engines
                .split(",")
                .map((name) => name.trim())
                .filter((name) => name !== ""),
              text,
              speed_unit: units.speed,
              temperature_unit: units.temperature,
              thrust_unit: units.thrust,
              source,
            },
          },
          { onSuccess: onDone },
        );
      }}
    >
      <Stack gap="sm" style={{ maxWidth: 640 }}>
        <Textarea
          label="Table"
          description="First row: a label, then total temperatures. Then a row for each rotation speed."
          required
          autosize
          minRows={6}
          maxRows={20}
          placeholder={EXAMPLE}
          styles={{ input: { fontFamily: "monospace" } }}
          value={text}
          onChange={(event) => {
            setText(event.currentTarget.value);
          }}
        />
        <Group grow align="end">
          {(["speed", "temperature", "thrust"] as const).map((key) => (
            <TextInput
              key={key}
              label={{ speed: "Speed in", temperature: "Temperature in", thrust: "Thrust in" }[key]}
              value={units[key]}
              onChange={(event) => {
                setUnits({ ...units, [key]: event.currentTarget.value });
              }}
            />
          ))}
        </Group>
        <TextInput
          label="Channels of the rotation speeds, one for each engine"
          required
          value={engines}
          onChange={(event) => {
            setEngines(event.currentTarget.value);
          }}
        />
        <TextInput
          label="Source"
          maxLength={500}
          value={source}
          onChange={(event) => {
            setSource(event.currentTarget.value);
          }}
        />
        <Text size="xs" className="quiet">
          Applied to maneuvers cut or imported from now on; existing maneuvers are unchanged.
        </Text>
        {save.isError && <ProblemAlert error={save.error} />}
        {remove.isError && <ProblemAlert error={remove.error} />}
        <Group>
          <Button type="submit" loading={save.isPending}>
            Save
          </Button>
          <Button variant="default" onClick={onDone}>
            Cancel
          </Button>
          {known && (
            <Button
              variant="subtle"
              color="red"
              loading={remove.isPending}
              onClick={() => {
                remove.mutate(aircraft.id, { onSuccess: onDone });
              }}
            >
              Delete table
            </Button>
          )}
        </Group>
      </Stack>
    </form>
  );
}

/** A stored table as text of the form. */
function asText(table: ThrustTable): string {
  const head = ["rpm", ...table.total_temperature_k.map((kelvin) => String(kelvin))];
  const rows = table.engine_speed_rad_s.map((speed, row) => [
    String(Number((speed / RPM).toPrecision(9))),
    ...(table.thrust_n[row] ?? []).map((value) => String(value)),
  ]);
  const all = table.total_temperature_k.length > 1 ? [head, ...rows] : rows;
  return all.map((cells) => cells.join(", ")).join("\n");
}

import { Button, Group, Modal, Stack, Switch, Text, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { address } from "../../api/client";
import { useCorrectMode } from "../../api/commands";
import { modesAtQuery } from "../../api/queries";
import type { ModeAtFuel } from "../../api/types";
import { fixed, percent, significant } from "../../lib/text/format";
import { symmetryLetter } from "../../lib/modes";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Figure } from "../figures/Figure";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";
import { quantity } from "../display/Quantity";
import { Section } from "../display/Section";
import { hasShapes, type TableProps } from "./tables";

/** Frequencies and damping over fuel, and the named modes at the selected fuel. */
export function FuelTab({ table, view }: TableProps) {
  const fuel = (view.fuel ?? 50) / 100;
  const modes = useQuery(modesAtQuery(table.id, fuel));
  const [corrected, setCorrected] = useState<ModeAtFuel | null>(null);
  return (
    <Stack gap="md">
      <div className="panel" style={{ padding: 12 }}>
        <Figure
          kind="modes-against-fuel"
          title="Frequency and damping over fuel; antisymmetric modes dashed, of unknown symmetry dotted, crossings circled"
          params={{ modal_table_id: table.id }}
        />
      </div>
      <Section
        title={`Modes at ${percent(fuel)} % fuel`}
        note="Names assigned by rule from the shapes; a correction is stored with its reason."
        actions={
          hasShapes(table) && (
            <Group gap="xs" className="no-print">
              {(["uff", "uff-single", "csv", "mat", "op4", "op4-binary"] as const).map((form) => (
                <Button
                  key={form}
                  size="compact-sm"
                  variant="default"
                  component="a"
                  href={address(`modal-tables/${String(table.id)}/file`, { form, fuel })}
                >
                  {form.replace("-", ", ").toUpperCase()}
                </Button>
              ))}
              <Button
                size="compact-sm"
                variant="default"
                component="a"
                href={address(`modal-tables/${String(table.id)}/archive`, { form: "mat" })}
              >
                All fuel weights, MAT (ZIP)
              </Button>
            </Group>
          )
        }
      >
        <Loaded query={modes} rows={8}>
          {({ items }) => (
            <DataTable
              label="Modes"
              testId="modes"
              columns={columnsOf(setCorrected)}
              rows={items}
              rowKey={(row) => row.number}
              maxHeight={520}
            />
          )}
        </Loaded>
      </Section>
      {corrected !== null && (
        <Correction
          tableId={table.id}
          mode={corrected}
          onClose={() => {
            setCorrected(null);
          }}
        />
      )}
    </Stack>
  );
}

const twice = (sigma: number | null) => (sigma === null ? null : 2 * sigma);

function columnsOf(correct: (mode: ModeAtFuel) => void): Column<ModeAtFuel>[] {
  return [
    { key: "number", header: "Mode", numeric: true, render: (row) => row.number },
    { key: "name", header: "Name", render: (row) => row.name },
    { key: "symmetry", header: "Symmetry", render: (row) => symmetryLetter(row.symmetric) },
    quantity("frequency", "Frequency", (row) => row.frequency_hz, "Hz", 3),
    {
      ...quantity<ModeAtFuel>(
        "frequency_std",
        "±2σ",
        (row) => twice(row.frequency_std_hz),
        "Hz",
        4,
      ),
      onlyIf: (row) => row.frequency_std_hz !== null,
    },
    numeric("damping", "Damping", (row) => percent(row.damping, 2), "%"),
    {
      ...numeric<ModeAtFuel>(
        "damping_std",
        "±2σ",
        (row) => percent(twice(row.damping_std), 3),
        "%",
      ),
      onlyIf: (row) => row.damping_std !== null,
    },
    numeric("mass", "Generalised mass", (row) => significant(row.mass_kg_m2, 4), "kg m²"),
    numeric("followed", "Lowest MAC over fuel", (row) => fixed(row.followed, 3)),
    {
      ...numeric<ModeAtFuel>("collinearity", "Phase collinearity", (row) =>
        fixed(row.collinearity, 3),
      ),
      help: "Phase collinearity",
      onlyIf: (row) => row.collinearity !== null,
    },
    { key: "reason", header: "Why", wraps: true, render: (row) => row.reason },
    {
      key: "correct",
      header: "",
      render: (row) => (
        <Button
          size="compact-xs"
          variant="subtle"
          onClick={() => {
            correct(row);
          }}
        >
          Correct
        </Button>
      ),
    },
  ];
}

interface CorrectionProps {
  tableId: number;
  mode: ModeAtFuel;
  onClose: () => void;
}

function Correction({ tableId, mode, onClose }: CorrectionProps) {
  const send = useCorrectMode(tableId);
  const [name, setName] = useState(mode.name);
  const [symmetric, setSymmetric] = useState(mode.symmetric ?? true);
  const [reason, setReason] = useState("");
  return (
    <Modal opened onClose={onClose} title={`Mode ${String(mode.number)}: ${mode.name}`}>
      <Stack gap="sm">
        <Text size="sm" className="quiet">
          {mode.reason}
        </Text>
        <TextInput
          label="Name"
          value={name}
          onChange={(event) => {
            setName(event.currentTarget.value);
          }}
        />
        <Switch
          label="Symmetric"
          checked={symmetric}
          onChange={(event) => {
            setSymmetric(event.currentTarget.checked);
          }}
        />
        <TextInput
          label="Why"
          required
          value={reason}
          onChange={(event) => {
            setReason(event.currentTarget.value);
          }}
        />
        {send.isError && <ProblemAlert error={send.error} />}
        <Group justify="end">
          <Button variant="default" onClick={onClose}>
            Cancel
          </Button>
          <Button
            loading={send.isPending}
            disabled={reason.trim() === "" || name.trim() === ""}
            onClick={() => {
              send.mutate(
                { number: mode.number, name: name.trim(), symmetric, reason },
                { onSuccess: onClose },
              );
            }}
          >
            {" "}
            Save{" "}
          </Button>
        </Group>
      </Stack>
    </Modal>
  );
}

import { Button, Group, MultiSelect, Select, Switch, TagsInput, Text } from "@mantine/core";
import type { Aircraft, ModalTable } from "../../api/types";
import { resized, type Structure } from "../../lib/structure";
import { NumberField } from "../controls/NumberField";

interface Props {
  structure: Structure;
  aircraft: Aircraft;
  tables: readonly ModalTable[];
  readOnly: boolean;
  onChange: (structure: Structure) => void;
}

/** Modes, inputs, outputs, delays and instruments of a structure. */
export function StructureParts({ structure, aircraft, tables, readOnly, onChange }: Props) {
  const surfaces = aircraft.surfaces.map((one) => one.name);
  const channels = [
    ...new Set([
      ...aircraft.combinations.map((one) => one.name),
      ...aircraft.sensors.map((one) => one.name),
    ]),
  ];
  const set = (part: Partial<Structure>) => {
    onChange({ ...structure, ...part });
  };
  const modal = tables.find((one) => one.kind === "FEM") ?? tables[0];
  const numbers = [...new Set([...(modal?.numbers ?? []), ...structure.modes])];
  const nameOf = (mode: number) => {
    const name = modal?.names[modal.numbers.indexOf(mode)];
    return name ? `${mode} ${name}` : String(mode);
  };
  return (
    <div className="halves">
      <div className="stack">
        <MultiSelect
          label="Modes"
          placeholder={structure.modes.length === 0 ? "rigid body only" : undefined}
          readOnly={readOnly}
          data={numbers.map((mode) => ({ value: String(mode), label: nameOf(mode) }))}
          value={structure.modes.map(String)}
          onChange={(value) => {
            const modes = numbers.filter((mode) => value.includes(String(mode)));
            onChange(resized(structure, { modes }, surfaces));
          }}
        />
        <MultiSelect
          label="Inputs"
          placeholder={structure.inputs.length === 0 ? "all of the maneuver" : undefined}
          readOnly={readOnly}
          data={surfaces}
          value={structure.inputs}
          onChange={(inputs) => {
            onChange(resized(structure, { inputs }, surfaces));
          }}
        />
        <MultiSelect
          label="Outputs"
          placeholder={structure.outputs.length === 0 ? "all suitable" : undefined}
          readOnly={readOnly}
          searchable
          data={channels}
          value={structure.outputs}
          onChange={(outputs) => {
            set({ outputs });
          }}
        />
      </div>
      <div className="stack">
        <TagsInput
          size="xs"
          label="Extra parameters"
          readOnly={readOnly}
          placeholder={
            structure.extra_parameters.length === 0 ? "none, e.g. delay_q, omega_7" : undefined
          }
          value={structure.extra_parameters}
          onChange={(extra_parameters) => {
            set({ extra_parameters });
          }}
        />
        <Switch
          label="Estimate a time delay of every output"
          disabled={readOnly}
          checked={structure.free_delays}
          onChange={(event) => {
            set({ free_delays: event.currentTarget.checked });
          }}
        />
        <Instruments
          structure={structure}
          channels={[...channels, ...surfaces]}
          instruments={Object.keys(aircraft.instruments)}
          readOnly={readOnly}
          onChange={set}
        />
      </div>
    </div>
  );
}

const AS_USUAL = "as on the aircraft";
const NONE = "none";

interface InstrumentsProps {
  structure: Structure;
  channels: readonly string[];
  instruments: readonly string[];
  readOnly: boolean;
  onChange: (part: Partial<Structure>) => void;
}

/** Channels whose instrument or delay differs from the aircraft's. */
function Instruments({ structure, channels, instruments, readOnly, onChange }: InstrumentsProps) {
  const named = [
    ...new Set([...Object.keys(structure.instruments), ...Object.keys(structure.delays)]),
  ];
  return (
    <div className="stack" role="group" aria-label="Instruments and known delays">
      <Text size="xs" fw={500}>
        Instruments and known delays
      </Text>
      {named.map((channel) => (
        <Group key={channel} gap="xs" wrap="nowrap">
          <Text size="sm" w={80}>
            {channel}
          </Text>
          <Select
            aria-label={`Instrument of ${channel}`}
            allowDeselect={false}
            readOnly={readOnly}
            data={[AS_USUAL, NONE, ...instruments]}
            value={
              channel in structure.instruments ? (structure.instruments[channel] ?? NONE) : AS_USUAL
            }
            onChange={(value) => {
              const others = without(structure.instruments, channel);
              onChange({
                instruments:
                  value === AS_USUAL
                    ? others
                    : { ...others, [channel]: value === NONE ? null : value },
                // The channel remains listed until it is removed.
                delays: { [channel]: 0, ...structure.delays },
              });
            }}
          />
          <NumberField
            aria-label={`Delay of ${channel}`}
            w={110}
            suffix=" ms"
            decimalScale={3}
            readOnly={readOnly}
            value={1000 * (structure.delays[channel] ?? 0)}
            onChange={(value) => {
              if (value === undefined) return;
              onChange({ delays: { ...structure.delays, [channel]: value / 1000 } });
            }}
          />
          {!readOnly && (
            <Button
              variant="subtle"
              size="compact-xs"
              onClick={() => {
                onChange({
                  delays: without(structure.delays, channel),
                  instruments: without(structure.instruments, channel),
                });
              }}
            >
              Remove
            </Button>
          )}
        </Group>
      ))}
      {!readOnly && (
        <Select
          aria-label="Channel with another instrument or a known delay"
          placeholder="Add a channel"
          searchable
          data={channels.filter((one) => !named.includes(one))}
          value={null}
          onChange={(channel) => {
            if (channel !== null) onChange({ delays: { ...structure.delays, [channel]: 0 } });
          }}
        />
      )}
      {readOnly && named.length === 0 && (
        <Text size="sm" className="quiet">
          {AS_USUAL}
        </Text>
      )}
    </div>
  );
}

function without<T>(record: Record<string, T>, name: string): Record<string, T> {
  return Object.fromEntries(Object.entries(record).filter(([key]) => key !== name));
}

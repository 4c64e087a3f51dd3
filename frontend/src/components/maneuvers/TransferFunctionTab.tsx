import { Alert, Select, Stack, Switch } from "@mantine/core";
import { storedResult, type AnalysisQuery } from "../../api/storedResult";
import type { TransferFunction } from "../../api/types";
import { overFrequency } from "../../lib/figures/band";
import { excitedInputs, named, offeredChannels } from "../../lib/channels";
import { withError } from "../../lib/text/format";
import { ComputedResult } from "../display/ComputedResult";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { NumberField } from "../controls/NumberField";
import type { ManeuverTabProps } from "./TimeHistoryTab";
import { WindowBar } from "./WindowBar";

const ORDERS = [
  { key: "zeros", label: "Zeros" },
  { key: "poles", label: "Poles" },
  { key: "integrators", label: "Integrators" },
] as const;

interface Quantity {
  name: string;
  unit: string;
  value: number;
  std: number;
}

const COLUMNS: Column<Quantity>[] = [
  {
    key: "name",
    header: "Quantity",
    render: (one) => (one.unit === "" ? one.name : `${one.name} [${one.unit}]`),
  },
  numeric("value", "Value", (one) => withError(one.value, one.std).value),
  numeric("std", "σ", (one) => withError(one.value, one.std).error),
];

/** Transfer function of one input and output: low-order equivalent system with delay. */
export function TransferFunctionTab({ maneuver, view, onChange }: ManeuverTabProps) {
  const excited = excitedInputs(maneuver);
  const commands = named(maneuver.channels, "command").filter((name) =>
    excited.includes(name.replace(/_command$/, "")),
  );
  const input = view.from_input ?? excited[0];
  const output = view.to_output ?? maneuver.default_channels.rates[0];
  if (input === undefined || output === undefined) {
    return <Empty title="No transfer function">It needs an input and an output.</Empty>;
  }
  const shared = overFrequency(view, onChange);
  const params = {
    maneuver_id: maneuver.id,
    input,
    output,
    zeros: view.zeros,
    poles: view.poles,
    integrators: view.integrators,
    delay: view.no_delay === true ? false : undefined,
    low_hz: shared.window?.[0],
    high_hz: shared.window?.[1],
  };
  return (
    <div className="split">
      <Stack gap="md">
        <Select
          label="Input"
          description="A surface: bare airframe. A command: augmented aircraft"
          data-testid="transfer-input"
          data={[...excited, ...commands]}
          value={input}
          allowDeselect={false}
          onChange={(name) => {
            onChange({ from_input: name ?? undefined });
          }}
        />
        <Select
          label="Output"
          searchable
          data-testid="transfer-output"
          data={offeredChannels(maneuver, ["output"]).map((group) => ({
            group: group.label,
            items: group.items.map((item) => item.name),
          }))}
          value={output}
          allowDeselect={false}
          onChange={(name) => {
            onChange({ to_output: name ?? undefined });
          }}
        />
        {ORDERS.map(({ key, label }) => (
          <NumberField
            key={key}
            label={label}
            placeholder="Usual for the output"
            min={0}
            max={6}
            allowDecimal={false}
            value={view[key]}
            onChange={(value) => {
              onChange({ [key]: value });
            }}
          />
        ))}
        <Switch
          label="Equivalent delay"
          checked={view.no_delay !== true}
          onChange={(event) => {
            onChange({ no_delay: event.currentTarget.checked ? undefined : true });
          }}
        />
      </Stack>
      <div className="panel" style={{ padding: 12 }}>
        <WindowBar
          window={shared.window}
          unit="Hz"
          onClear={() => {
            shared.onWindow(null);
          }}
          hint="Excited frequencies below the first mode that these orders do not describe. Drag over the figure to select a band; spectra and responses share it."
          whole="Default band"
        />
        <ComputedResult options={storedResult("/api/v1/transfer-functions", { query: params })}>
          {(found) => <Fit found={found} params={params} shared={shared} />}
        </ComputedResult>
      </div>
    </div>
  );
}

function Fit({
  found,
  params,
  shared,
}: {
  found: TransferFunction;
  params: AnalysisQuery<"/api/v1/transfer-functions">;
  shared: ReturnType<typeof overFrequency>;
}) {
  return (
    <Stack gap="sm">
      <Alert
        color={found.is_close ? "green" : "yellow"}
        variant="light"
        role="status"
        data-testid="transfer-function"
      >
        {found.sentence}
      </Alert>
      {found.warnings.map((warning) => (
        <Alert key={warning} color="yellow" variant="light" title={warning} />
      ))}
      <DataTable
        label={`Transfer function of ${found.output} over ${found.input}`}
        columns={COLUMNS}
        rows={list(found)}
        rowKey={(one) => one.name}
      />
      <Figure
        kind="transfer-function"
        title={`Response of ${found.output} to ${found.input}, and its transfer function`}
        params={{ ...params }}
        {...shared}
      />
    </Stack>
  );
}

/** Gain, delay, and the frequency and damping ratio, or inverse time constant, of each root. */
function list(found: TransferFunction): Quantity[] {
  const delay = {
    name: "Equivalent delay",
    unit: "s",
    value: found.delay_s,
    std: found.delay_std_s,
  };
  return [
    { name: "Gain", unit: found.gain_unit, value: found.gain, std: found.gain_std },
    ...(found.has_delay ? [delay] : []),
    ...found.zeros.flatMap((root, k) => quantities("Zero", k + 1, root)),
    ...found.poles.flatMap((root, k) => quantities("Pole", k + 1, root)),
  ];
}

function quantities(
  kind: string,
  number: number,
  root: TransferFunction["poles"][number],
): Quantity[] {
  const name = `${kind} ${String(number)}`;
  const std = root.frequency_std_rad_s;
  if (root.imag_rad_s === 0) {
    return [{ name: `${name}, 1/T`, unit: "rad/s", value: -root.real_rad_s, std }];
  }
  return [
    { name: `${name}, frequency`, unit: "rad/s", value: root.frequency_rad_s, std },
    { name: `${name}, damping ratio`, unit: "", value: root.damping, std: root.damping_std },
  ];
}

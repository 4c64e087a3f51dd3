import { Alert, Select, Stack, TagsInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { modelOrderQuery } from "../../api/queries";
import type { ModelOrder } from "../../api/types";
import { fixed, percent } from "../../lib/text/format";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Figure } from "../figures/Figure";
import { Loaded } from "../display/Loaded";
import { NumberField } from "../controls/NumberField";
import { Section } from "../display/Section";
import type { TableProps } from "./tables";

type Step = ModelOrder["steps"][number];

/** Model order of a condition: derivatives, poles and responses of reduced models. */
export function OrderTab({ aircraft, table, view, onChange }: TableProps) {
  const query = {
    aircraft_id: aircraft.id,
    modal_table_id: table.kind === "FEM" ? table.id : undefined,
    airspeed_m_s: view.airspeed ?? 40,
    altitude_m: view.altitude ?? 0,
    fuel: (view.fuel ?? 50) / 100,
    high_hz: view.up_to ?? 15,
  };
  const order = useQuery(modelOrderQuery(query));
  const derivatives = view.derivatives ?? ["CZ_alpha", "Cm_alpha", "CZ_q", "Cm_q"];
  const outputs = [...aircraft.combinations, ...aircraft.sensors].map((one) => one.name);
  const output = view.output ?? outputs.find((name) => name === "q") ?? outputs[0];
  const surface = view.surface ?? aircraft.surfaces[0]?.name;
  return (
    <div className="split split-early">
      <Stack gap="md">
        <NumberField
          label="Airspeed"
          unit="m/s"
          min={1}
          value={view.airspeed ?? 40}
          onChange={(value) => {
            onChange({ airspeed: value });
          }}
        />
        <NumberField
          label="Altitude"
          unit="m"
          min={-1000}
          max={11000}
          value={view.altitude ?? 0}
          onChange={(value) => {
            onChange({ altitude: value });
          }}
        />
        <NumberField
          label="Band up to"
          unit="Hz"
          min={1}
          value={view.up_to ?? 15}
          onChange={(value) => {
            onChange({ up_to: value });
          }}
        />
        <TagsInput
          label="Derivatives"
          value={derivatives}
          data={Object.keys(order.data?.full ?? {}).filter((name) => /^C[Zm]_/.test(name))}
          maxDropdownHeight={260}
          onChange={(names) => {
            onChange({ derivatives: names });
          }}
        />
        <Select
          label="Response of"
          searchable
          data={outputs}
          value={output ?? null}
          onChange={(value) => {
            onChange({ output: value ?? undefined });
          }}
        />
        <Select
          label="to"
          data={aircraft.surfaces.map((one) => one.name)}
          value={surface ?? null}
          onChange={(value) => {
            onChange({ surface: value ?? undefined });
          }}
        />
      </Stack>
      <Loaded query={order} rows={10}>
        {(data) => (
          <Stack gap="md">
            <Proposal result={data} />
            <div className="panel" style={{ padding: 12 }}>
              <Figure
                kind="model-order"
                title="Derivatives over retained modes, ±10 % about the full model"
                params={{ ...query, derivatives: derivatives.join(",") }}
              />
            </div>
            {output !== undefined && surface !== undefined && (
              <div className="panel" style={{ padding: 12 }}>
                <Figure
                  kind="reduced-responses"
                  title="Responses of full and reduced models, and of rigid-body sensors"
                  params={{ ...query, output, surface, counts: "0,1,2,3,4" }}
                  height={520}
                />
              </div>
            )}
            <Section title="Evidence" note="Poles of residualised models, ωn [Hz] and ζ">
              <DataTable
                label="Reduced models"
                testId="reduced-models"
                columns={COLUMNS}
                rows={data.steps}
                rowKey={(row) => row.modes.length}
              />
            </Section>
          </Stack>
        )}
      </Loaded>
    </div>
  );
}

function Proposal({ result }: { result: ModelOrder }) {
  const needed = result.steps[result.needed];
  return (
    <Alert
      color="blue"
      variant="light"
      title={`Modes required at this condition: ${["SP", ...(needed?.names ?? [])].join(" + ")}`}
      data-testid="order-proposal"
      styles={{ title: { color: "var(--mantine-color-text)" } }}
    >
      {result.evidence.join(" ")}
    </Alert>
  );
}

const COLUMNS: Column<Step>[] = [
  { key: "count", header: "Modes", numeric: true, render: (row) => row.modes.length },
  { key: "last", header: "Last mode", render: (row) => row.names.at(-1) ?? "rigid" },
  { key: "worst", header: "Worst derivative", render: (row) => row.worst },
  { key: "bias", header: "Error", unit: "%", numeric: true, render: (row) => percent(row.bias, 1) },
  {
    key: "pole",
    header: "Pole error",
    unit: "%",
    numeric: true,
    render: (row) => (row.pole_error === null ? "missing" : percent(row.pole_error, 1)),
  },
  numeric("response", "Response error", (row) => percent(row.response_error, 1), "%"),
  {
    key: "poles",
    header: "Poles",
    wraps: true,
    render: (row) =>
      row.poles
        .map(([re = 0, im = 0]) => {
          const size = Math.hypot(re, im);
          return `${fixed(size / 2 / Math.PI, 2)} (${fixed(-re / size, 3)})`;
        })
        .join(", "),
  },
  { key: "enough", header: "Sufficient", render: (row) => (row.sufficient ? "yes" : "no") },
];

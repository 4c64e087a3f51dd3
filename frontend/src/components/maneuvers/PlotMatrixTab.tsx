import { SegmentedControl, Stack, Text, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { figureQuery } from "../../api/queries";
import { offeredChannels } from "../../lib/channels";
import { integers } from "../../lib/urlState";
import { ChannelPicker } from "../controls/ChannelPicker";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import type { ManeuverTabProps } from "./TimeHistoryTab";

interface Meta {
  names?: string[];
  inflation?: (number | null)[];
  condition?: number | null;
}

/** Plot matrix of channels or equation-error regressors, with their collinearity. */
export function PlotMatrixTab({ maneuver, view, onChange }: ManeuverTabProps) {
  const channels = view.channels ?? maneuver.default_channels.inputs;
  const modes = view.regressors;
  const domain = modes === undefined ? (view.domain ?? "time") : "frequency";
  const params = {
    maneuver_id: maneuver.id,
    channels: modes === undefined ? channels : undefined,
    domain,
    modes,
  };
  const count = modes === undefined ? channels.length : undefined;
  return (
    <div className="split">
      <Stack gap="md">
        <SegmentedControl
          aria-label="Domain"
          data={[
            { value: "time", label: "Time" },
            { value: "frequency", label: "Frequency" },
          ]}
          value={domain}
          disabled={modes !== undefined}
          onChange={(value) => {
            onChange({ domain: value === "frequency" ? "frequency" : undefined });
          }}
        />
        <TextInput
          label="Regressors of modes"
          description="Mode numbers; empty compares channels"
          placeholder="7, 9"
          defaultValue={modes?.join(", ") ?? ""}
          onBlur={(event) => {
            onChange({ regressors: integers(event.currentTarget.value) });
          }}
          onKeyDown={(event) => {
            if (event.key === "Enter") event.currentTarget.blur();
          }}
        />
        {count !== undefined && (
          <ChannelPicker
            label="Channels"
            groups={offeredChannels(maneuver)}
            value={channels}
            onChange={(names) => {
              onChange({ channels: names });
            }}
          />
        )}
        <Inflation params={params} />
      </Stack>
      <div className="panel" style={{ padding: 12 }}>
        {count !== undefined && count < 2 ? (
          <Empty title="No channels selected">Select two or more channels on the left.</Empty>
        ) : (
          <Figure
            kind="plot-matrix"
            title="Plot matrix with correlations"
            params={params}
            height={760}
          />
        )}
      </div>
    </div>
  );
}

const INFLATION: Column<{ name: string; factor: number | null | undefined }>[] = [
  { key: "name", header: "Column", render: (one) => one.name },
  numeric("factor", "Factor", ({ factor }) => {
    const text = factor?.toFixed(2) ?? "–";
    return (factor ?? Infinity) > 10 ? <strong>{text}</strong> : text;
  }),
];

/** Variance inflation of every column, from the response of the figure. */
function Inflation({ params }: { params: Parameters<typeof figureQuery>[1] }) {
  const figure = useQuery(figureQuery("plot-matrix", params));
  const meta = figure.data?.layout.meta as Meta | undefined;
  if (!Array.isArray(meta?.inflation) || meta.names === undefined) return null;
  const factors = meta.inflation;
  return (
    <div data-testid="inflation">
      <Text size="sm" fw={600}>
        Variance inflation
      </Text>
      <Text size="xs" className="quiet numbers">
        Condition number {meta.condition === null ? "infinite" : meta.condition?.toFixed(1)}
      </Text>
      <div className="panel">
        <DataTable
          label="Variance inflation"
          columns={INFLATION}
          rows={meta.names.map((name, index) => ({ name, factor: factors[index] }))}
          rowKey={(one) => one.name}
        />
      </div>
    </div>
  );
}

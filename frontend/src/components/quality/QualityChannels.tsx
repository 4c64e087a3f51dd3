import type { ChannelQuality } from "../../api/types";
import { fixed, percent, significant } from "../../lib/text/format";
import { DataTable, type Column } from "../controls/DataTable";

const columns: Column<ChannelQuality>[] = [
  { key: "name", header: "Channel", render: (one) => one.name },
  { key: "role", header: "Role", render: (one) => one.role },
  {
    key: "signal",
    header: <span title="Median over all frequencies">Signal/noise</span>,
    unit: "dB",
    numeric: true,
    render: (one) => fixed(one.signal_to_noise_db, 1),
  },
  {
    key: "coherence",
    header: <span title="With the signal predicted from all other sensors">Coherence</span>,
    numeric: true,
    render: (one) => fixed(one.coherence, 3),
  },
  {
    key: "excess",
    header: (
      <span title="Deviation from the other sensors relative to the known noise">Excess noise</span>
    ),
    numeric: true,
    render: (one) => fixed(one.noise_excess, 1),
  },
  {
    key: "skew",
    header: "Skew",
    unit: "ms",
    numeric: true,
    render: (one) =>
      withStd(one.delay_s, one.delay_std, 1e3, 2, standsOut(one.delay_s, one.delay_std)),
  },
  {
    key: "scale",
    header: "Scale factor",
    numeric: true,
    render: (one) =>
      withStd(
        one.scale,
        one.scale_std,
        1,
        3,
        standsOut(one.scale === null ? null : one.scale - 1, one.scale_std),
      ),
  },
  {
    key: "checked",
    header: <span title="Against the other sensors">Checked</span>,
    render: (one) => <Checked channel={one} />,
  },
  {
    key: "bias",
    header: "Bias",
    numeric: true,
    render: (one) =>
      one.bias === null ? (
        "–"
      ) : (
        <span
          title={one.bias_basis}
          style={{ fontWeight: standsOut(one.bias, one.bias_std) ? 700 : undefined }}
        >
          {significant(one.bias, 3)} ± {significant(one.bias_std, 2)} {one.unit}
        </span>
      ),
  },
  {
    key: "stretches",
    header: <span title="Spikes, dropouts and saturated intervals">Spikes</span>,
    numeric: true,
    render: (one) => (one.n_stretches === 0 ? "–" : <b>{one.n_stretches}</b>),
  },
  {
    key: "saturated",
    header: "Saturated",
    unit: "%",
    numeric: true,
    render: (one) => (one.saturated > 0 ? percent(one.saturated, 2) : "–"),
  },
];

/** Quality figures of every checked channel. */
export function QualityChannels({ channels }: { channels: ChannelQuality[] }) {
  return (
    <DataTable
      label="Channels"
      testId="quality-channels"
      columns={columns}
      rows={channels.filter((one) => one.role === "input" || one.role === "output")}
      rowKey={(one) => one.name}
      maxHeight={520}
    />
  );
}

function Checked({ channel }: { channel: ChannelQuality }) {
  if (channel.role !== "output") return "–";
  if (channel.not_checked === null) return "yes";
  return <span title={channel.not_checked}>cannot be checked</span>;
}

const standsOut = (value: number | null, std: number | null) =>
  value !== null && std !== null && std > 0 && Math.abs(value) > 3 * std;

function withStd(
  value: number | null,
  std: number | null,
  factor: number,
  decimals: number,
  strong: boolean,
) {
  if (value === null || std === null) return "–";
  const text = `${fixed(factor * value, decimals)} ± ${fixed(factor * std, decimals)}`;
  return strong ? <b>{text}</b> : text;
}

import type { SurfaceQuality } from "../../api/types";
import { fixed, percent } from "../../lib/text/format";
import { DataTable, type Column } from "../controls/DataTable";
import { Quantity, UnitName } from "../display/Quantity";

const columns: Column<SurfaceQuality>[] = [
  { key: "name", header: "Surface", render: (one) => one.name },
  {
    key: "gain",
    header: <span title="Deflection over command at low frequency, of the servo fitted">Gain</span>,
    numeric: true,
    render: (one) =>
      one.gain !== null && one.gain < 0 ? <b>{fixed(one.gain, 3)}</b> : fixed(one.gain, 3),
  },
  {
    key: "delay",
    header: <span title="Pure delay of the servo, known instruments removed">Delay</span>,
    unit: "ms",
    numeric: true,
    render: (one) => fixed(scaled(one.delay_s, 1e3), 1),
  },
  {
    key: "frequency",
    header: <span title="Natural frequency of the servo">Frequency</span>,
    unit: <UnitName unit="Hz" />,
    numeric: true,
    render: (one) => <Quantity value={one.natural_frequency_hz} unit="Hz" decimals={2} />,
  },
  {
    key: "damping",
    header: <span title="Damping ratio of the servo">Damping</span>,
    numeric: true,
    render: (one) => fixed(one.damping, 3),
  },
  {
    key: "feedback",
    header: <span title="Outputs that the controller moves the surface with">Fed back</span>,
    render: (one) => one.fed_back.join(", ") || "–",
  },
  {
    key: "motion",
    header: <span title="Largest oscillation that was not commanded">Uncommanded</span>,
    unit: <UnitName unit="rad" />,
    numeric: true,
    render: (one) =>
      one.motion === null ? (
        "–"
      ) : (
        <>
          <Quantity value={one.motion} unit="rad" decimals={5} /> at{" "}
          <Quantity value={one.motion_hz} unit="Hz" decimals={2} named />
        </>
      ),
  },
  {
    key: "rate",
    header: (
      <span title="Rate that the surface does not exceed, and the share of the time">
        Rate limit
      </span>
    ),
    unit: <UnitName unit="rad/s" />,
    numeric: true,
    render: (one) =>
      one.rate_limit === null ? (
        "–"
      ) : (
        <b>
          <Quantity value={one.rate_limit} unit="rad/s" decimals={2} /> (
          {percent(one.rate_limited, 1)} %)
        </b>
      ),
  },
  {
    key: "lost",
    header: <span title="Harmonics that were commanded and not flown">Lost harmonics</span>,
    render: (one) => (one.lost.length === 0 ? "–" : <b>{one.lost.join(", ")}</b>),
  },
  {
    key: "checked",
    header: "Follows its command",
    render: (one) => <Followed surface={one} />,
  },
];

/** Surfaces as flown against their recorded commands. */
export function QualitySurfaces({ surfaces }: { surfaces: SurfaceQuality[] }) {
  return (
    <DataTable
      label="Surfaces"
      testId="quality-surfaces"
      columns={columns}
      rows={surfaces}
      rowKey={(one) => one.name}
    />
  );
}

function Followed({ surface }: { surface: SurfaceQuality }) {
  if (surface.not_checked !== null) return `cannot be checked: ${surface.not_checked}`;
  if (surface.gain === null) return <b>no</b>;
  return surface.gain < 0 ? <b>reversed</b> : "yes";
}

const scaled = (value: number | null, factor: number) => (value === null ? null : factor * value);

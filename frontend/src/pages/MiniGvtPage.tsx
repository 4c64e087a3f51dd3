import { Alert } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { groundTestQuery, groundTestsQuery } from "../api/queries";
import type { GroundTest } from "../api/types";
import { DataTable, numeric, type Column } from "../components/controls/DataTable";
import { Empty } from "../components/display/Empty";
import { GroundTestAlarm } from "../components/frame/GroundTestAlarm";
import { Figure } from "../components/figures/Figure";
import { Loaded } from "../components/display/Loaded";
import { quantity, Quantity, UnitName } from "../components/display/Quantity";
import { PageHead } from "../components/frame/PageHead";
import { Section } from "../components/display/Section";
import { percent } from "../lib/text/format";

const route = getRouteApi("/flights/$id/mini-gvt");

type Peak = GroundTest["peaks"][number];

const LOOKS = {
  healthy: { color: "green", title: "Change explained by fuel" },
  watch: { color: "yellow", title: "Amplitude change" },
  alarm: { color: "red.9", title: "Structural change indicated: inspect before flight" },
} as const;

/** Frequency changes of every flight that has a mini-GVT. */
export function GroundTestsPage() {
  return (
    <>
      <PageHead title="Mini-GVT" />
      <GroundTestAlarm />
      <Tracked />
    </>
  );
}

/** Peaks on the runway before and after a flight, and the verdict on the structure. */
export function MiniGvtPage() {
  const { id } = route.useParams();
  const test = useQuery(groundTestQuery(id));
  return (
    <Loaded query={test} page="Mini-GVT">
      {(data) => <OneTest test={data} />}
    </Loaded>
  );
}

function OneTest({ test }: { test: GroundTest }) {
  const look = LOOKS[test.verdict];
  return (
    <>
      <PageHead
        title={`Mini-GVT of flight ${test.flight_number}`}
        trail={[
          <Link to="/campaign" className="link" key="campaign">
            Campaign
          </Link>,
          <Link to="/flights/$id" params={{ id: test.flight_id }} className="link" key="flight">
            Flight {test.flight_number}
          </Link>,
        ]}
      />
      <Alert
        color={look.color}
        variant={test.verdict === "alarm" ? "filled" : "light"}
        role={test.verdict === "alarm" ? "alert" : "status"}
        title={look.title}
        mb="md"
        data-testid={`verdict-${test.verdict}`}
      >
        {test.message}
      </Alert>
      <Section
        title="Peaks"
        note={`Fuel ${percent(test.fuel_before)} % before, ${percent(test.fuel_after)} % after`}
      >
        <PeakTable test={test} />
      </Section>
      <div className="panel" style={{ padding: 12, marginTop: 16 }}>
        <Figure
          kind="ground-test"
          title="Spectra on the runway"
          params={{ flight_id: test.flight_id }}
        />
      </div>
      <div style={{ marginTop: 16 }}>
        <Tracked />
      </div>
    </>
  );
}

function PeakTable({ test }: { test: GroundTest }) {
  const columns: Column<Peak>[] = [
    { key: "mode", header: "Mode", render: (peak) => peak.name },
    quantity("before", "Before", (peak) => peak.before_hz, "Hz", 3),
    {
      key: "after",
      header: "After",
      unit: <UnitName unit="Hz" />,
      numeric: true,
      render: (peak) =>
        peak.after_hz === null ? (
          "not found"
        ) : (
          <Quantity value={peak.after_hz} unit="Hz" decimals={3} />
        ),
    },
    numeric("change", "Change", (peak) => percent(peak.change, 2), "%"),
    numeric("fuel", "Explained by fuel", (peak) => percent(peak.explained, 2), "%"),
    numeric(
      "residual",
      "Residual ±2σ",
      (peak) => {
        const std = peak.unexplained_std;
        const text = percent(peak.unexplained, 2);
        const whole = std === null ? text : `${text} ± ${percent(2 * std, 2)}`;
        return peak.verdict === "alarm" ? <strong>{whole}</strong> : whole;
      },
      "%",
    ),
    numeric("amplitude", "Amplitude", (peak) => percent(peak.amplitude_change), "%"),
    numeric("damping", "Explained by damping", (peak) => percent(peak.amplitude_explained), "%"),
  ];
  return (
    <DataTable label="Peaks" columns={columns} rows={test.peaks} rowKey={(peak) => peak.mode} />
  );
}

const TRACKED: Column<{ test: GroundTest; peak: Peak }>[] = [
  {
    key: "flight",
    header: "Flight",
    render: ({ test }) => (
      <Link to="/flights/$id/mini-gvt" params={{ id: test.flight_id }} className="link">
        Flight {test.flight_number}
      </Link>
    ),
  },
  { key: "mode", header: "Mode", render: ({ peak }) => peak.name },
  numeric("residual", "Residual", ({ peak }) => percent(peak.unexplained, 2), "%"),
  { key: "verdict", header: "Verdict", render: ({ peak }) => peak.verdict },
];

/** Frequency change of each mode that fuel does not explain, by flight. */
function Tracked() {
  const tests = useQuery(groundTestsQuery);
  return (
    <Section title="All flights" note="Frequency change not explained by fuel [%], by mode">
      <Loaded query={tests}>
        {(items) =>
          items.length === 0 ? (
            <Empty title="No mini-GVT yet">
              Import a flight with records on the runway before and after it.
            </Empty>
          ) : (
            <DataTable
              label="Residual frequency changes"
              columns={TRACKED}
              rows={items.flatMap((test) => test.peaks.map((peak) => ({ test, peak })))}
              rowKey={({ test, peak }) => `${test.flight_id} ${peak.mode}`}
            />
          )
        }
      </Loaded>
    </Section>
  );
}

import { Alert, Table } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { groundTestQuery, groundTestsQuery } from "../api/queries";
import type { GroundTest } from "../api/types";
import { Empty } from "../components/Empty";
import { GroundTestAlarm } from "../components/GroundTestAlarm";
import { Figure } from "../components/Figure";
import { Loaded } from "../components/Loaded";
import { Quantity, UnitName } from "../components/Quantity";
import { PageHead } from "../components/PageHead";
import { Section } from "../components/Section";
import { percent } from "../lib/format";

const route = getRouteApi("/flights/$id/mini-gvt");

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
  return (
    <Table className="numbers" fz="sm">
      <Table.Thead>
        <Table.Tr>
          <Table.Th>Mode</Table.Th>
          <Table.Th ta="right">
            Before [<UnitName unit="Hz" />]
          </Table.Th>
          <Table.Th ta="right">
            After [<UnitName unit="Hz" />]
          </Table.Th>
          <Table.Th ta="right">Change [%]</Table.Th>
          <Table.Th ta="right">Explained by fuel [%]</Table.Th>
          <Table.Th ta="right">Residual ±2σ [%]</Table.Th>
          <Table.Th ta="right">Amplitude [%]</Table.Th>
          <Table.Th ta="right">Explained by damping [%]</Table.Th>
        </Table.Tr>
      </Table.Thead>
      <Table.Tbody>
        {test.peaks.map((peak) => (
          <Table.Tr key={peak.mode}>
            <Table.Td>{peak.name}</Table.Td>
            <Table.Td ta="right">
              <Quantity value={peak.before_hz} unit="Hz" decimals={3} />
            </Table.Td>
            <Table.Td ta="right">
              {peak.after_hz === null ? (
                "not found"
              ) : (
                <Quantity value={peak.after_hz} unit="Hz" decimals={3} />
              )}
            </Table.Td>
            <Table.Td ta="right">{percent(peak.change, 2)}</Table.Td>
            <Table.Td ta="right">{percent(peak.explained, 2)}</Table.Td>
            <Table.Td ta="right" fw={peak.verdict === "alarm" ? 700 : undefined}>
              {percent(peak.unexplained, 2)}
              {peak.unexplained_std !== null && ` ± ${percent(2 * peak.unexplained_std, 2)}`}
            </Table.Td>
            <Table.Td ta="right">{percent(peak.amplitude_change)}</Table.Td>
            <Table.Td ta="right">{percent(peak.amplitude_explained)}</Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}

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
            <Table className="numbers" fz="sm">
              <Table.Thead>
                <Table.Tr>
                  <Table.Th>Flight</Table.Th>
                  <Table.Th>Mode</Table.Th>
                  <Table.Th ta="right">Residual [%]</Table.Th>
                  <Table.Th>Verdict</Table.Th>
                </Table.Tr>
              </Table.Thead>
              <Table.Tbody>
                {items.flatMap((test) =>
                  test.peaks.map((peak) => (
                    <Table.Tr key={`${test.flight_id} ${peak.mode}`}>
                      <Table.Td>
                        <Link
                          to="/flights/$id/mini-gvt"
                          params={{ id: test.flight_id }}
                          className="link"
                        >
                          Flight {test.flight_number}
                        </Link>
                      </Table.Td>
                      <Table.Td>{peak.name}</Table.Td>
                      <Table.Td ta="right">{percent(peak.unexplained, 2)}</Table.Td>
                      <Table.Td>{peak.verdict}</Table.Td>
                    </Table.Tr>
                  )),
                )}
              </Table.Tbody>
            </Table>
          )
        }
      </Loaded>
    </Section>
  );
}

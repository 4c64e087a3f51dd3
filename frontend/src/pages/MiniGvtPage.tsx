import { Alert, Table } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { groundTestQuery, groundTestsQuery } from "../api/queries";
import type { GroundTest } from "../api/types";
import { Figure } from "../components/Figure";
import { Loaded } from "../components/Loaded";
import { PageHead } from "../components/PageHead";
import { Section } from "../components/Section";
import { fixed, percent } from "../lib/format";

const route = getRouteApi("/flights/$id/mini-gvt");

const LOOKS = {
  healthy: { color: "green", title: "Nothing but fuel changed" },
  watch: { color: "yellow", title: "An amplitude changed" },
  alarm: { color: "red.9", title: "The structure changed: do not fly" },
} as const;

/** The records on the runway before and after a flight, and what they say of the structure. */
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
          <Table.Th ta="right">Before [Hz]</Table.Th>
          <Table.Th ta="right">After [Hz]</Table.Th>
          <Table.Th ta="right">Change [%]</Table.Th>
          <Table.Th ta="right">Fuel explains [%]</Table.Th>
          <Table.Th ta="right">Left over ±2σ [%]</Table.Th>
          <Table.Th ta="right">Amplitude [%]</Table.Th>
          <Table.Th ta="right">Damping explains [%]</Table.Th>
        </Table.Tr>
      </Table.Thead>
      <Table.Tbody>
        {test.peaks.map((peak) => (
          <Table.Tr key={peak.mode}>
            <Table.Td>{peak.name}</Table.Td>
            <Table.Td ta="right">{fixed(peak.before_hz, 3)}</Table.Td>
            <Table.Td ta="right">
              {peak.after_hz === null ? "not found" : fixed(peak.after_hz, 3)}
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

/** Every flight of the campaign in one glance. */
function Tracked() {
  const tests = useQuery(groundTestsQuery);
  return (
    <Section title="All flights" note="What fuel does not explain [%], by mode">
      <Loaded query={tests}>
        {(items) => (
          <Table className="numbers" fz="sm">
            <Table.Thead>
              <Table.Tr>
                <Table.Th>Flight</Table.Th>
                <Table.Th>Mode</Table.Th>
                <Table.Th ta="right">Left over [%]</Table.Th>
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
        )}
      </Loaded>
    </Section>
  );
}

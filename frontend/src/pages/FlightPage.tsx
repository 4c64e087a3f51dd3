import { Button, Group, Stack, Text } from "@mantine/core";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import {
  flightChannelsQuery,
  flightQuery,
  maneuverProposalsQuery,
  groundTestsQuery,
  maneuversQuery,
} from "../api/queries";
import type { Flight, FlightChannel, ManeuverItem } from "../api/types";
import { ButtonLink } from "../components/controls/ButtonLink";
import { ChannelPicker } from "../components/controls/ChannelPicker";
import { CutForm } from "../components/maneuvers/CutForm";
import { DataTable, numeric, type Column } from "../components/controls/DataTable";
import { Empty } from "../components/display/Empty";
import { Figure } from "../components/figures/Figure";
import { ManeuverProposals } from "../components/maneuvers/ManeuverProposals";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { Section } from "../components/display/Section";
import { byRole, named } from "../lib/channels";
import { count, fixed, flightName, percent } from "../lib/text/format";
import type { FlightView } from "../views";

const route = getRouteApi("/flights/$id");

/** One flight: its maneuvers, and its recording, from which maneuvers are cut. */
export function FlightPage() {
  const { id } = route.useParams();
  const flight = useQuery(flightQuery(id));
  return (
    <Loaded query={flight} page={`Flight ${id}`}>
      {(data) => <OneFlight flight={data} />}
    </Loaded>
  );
}

function OneFlight({ flight }: { flight: Flight }) {
  const channels = useQuery(flightChannelsQuery(flight.id));
  const ground = useQuery(groundTestsQuery);
  const tested = ground.data?.some((test) => test.flight_id === flight.id) === true;
  return (
    <>
      <PageHead
        title={flightName(flight.number)}
        trail={[
          <Link to="/campaign" className="link" key="campaign">
            Campaign
          </Link>,
        ]}
        aside={
          <Text size="sm" className="quiet">
            {[flight.flown_on, flight.description].filter(Boolean).join(", ")}
          </Text>
        }
        actions={
          tested && (
            <ButtonLink variant="default" to="/flights/$id/mini-gvt" params={{ id: flight.id }}>
              Mini-GVT
            </ButtonLink>
          )
        }
      />
      <Stack gap="md">
        <Maneuvers flight={flight} />
        <Loaded query={channels}>
          {(recorded) =>
            recorded.length === 0 ? (
              <Section title="Recording">
                <Empty title="No recording of the whole flight">
                  Import its files with a mapping that has no [maneuver]; maneuvers are then cut
                  here.
                </Empty>
              </Section>
            ) : (
              <Recording flight={flight} channels={recorded} />
            )
          }
        </Loaded>
      </Stack>
    </>
  );
}

const maneuverColumns: Column<ManeuverItem>[] = [
  {
    key: "label",
    header: "Maneuver",
    render: (one) => (
      <Link to="/maneuvers/$id" params={{ id: one.id }} className="link">
        {one.label}
      </Link>
    ),
  },
  { key: "fta", header: "FTA", numeric: true, render: (one) => one.fta ?? "–" },
  {
    key: "ratio",
    header: (
      <>
        V/V<sub>f</sub>
      </>
    ),
    numeric: true,
    render: (one) => fixed(one.airspeed_ratio, 3),
  },
  numeric("fuel", "Fuel", (one) => percent(one.fuel_fraction), "%"),
  numeric("length", "Length", (one) => fixed(one.duration_s, 1), "s"),
  { key: "runs", header: "Runs", numeric: true, render: (one) => one.n_runs },
];

function Maneuvers({ flight }: { flight: Flight }) {
  const list = useInfiniteQuery(maneuversQuery({ flight_id: flight.id }, "id", 200));
  return (
    <Section title="Maneuvers" note={list.data && count(itemsOf(list.data).length, "maneuver")}>
      <Loaded query={list}>
        {(data) =>
          itemsOf(data).length === 0 ? (
            <Text size="sm" className="quiet">
              No maneuvers yet.
            </Text>
          ) : (
            <DataTable
              label="Maneuvers of the flight"
              testId="flight-maneuvers"
              columns={maneuverColumns}
              rows={itemsOf(data)}
              rowKey={(one) => one.id}
              maxHeight={300}
            />
          )
        }
      </Loaded>
    </Section>
  );
}

const itemsOf = (data: { pages: { items: ManeuverItem[] }[] }) =>
  data.pages.flatMap((page) => page.items);

function Recording({ flight, channels }: { flight: Flight; channels: FlightChannel[] }) {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const found = useQuery(maneuverProposalsQuery(flight.id));
  const change = (part: Partial<FlightView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });
  const first = named(channels, "command").slice(0, 2);
  const shown = view.channels ?? [
    ...(first.length > 0 ? first : named(channels, "input").slice(0, 2)),
    ...named(channels, "output").slice(0, 2),
  ];
  const window: [number, number] | undefined =
    view.from !== undefined && view.to !== undefined ? [view.from, view.to] : undefined;
  return (
    <>
      <Section
        title="Detected maneuvers"
        note="From the recorded excitation, a marker, or the surface motion; including trim before and decay after"
      >
        {found.isError ? (
          <ProblemAlert error={found.error} />
        ) : (
          <Loaded query={found}>
            {(items) => (
              <ManeuverProposals
                flightId={flight.id}
                items={items}
                onLook={(one) => {
                  change({
                    from: one.start_s,
                    to: one.stop_s,
                    label: one.label,
                    fta: one.fta ?? undefined,
                  });
                }}
              />
            )}
          </Loaded>
        )}
      </Section>
      <Section
        title="Recording"
        note={
          window === undefined
            ? "Drag over the figure to select the window of a maneuver"
            : `Window from ${fixed(window[0], 2)} to ${fixed(window[1], 2)} s: drag again to narrow it`
        }
        actions={
          <Group gap="xs">
            <Button
              variant="default"
              disabled={window === undefined}
              onClick={() => {
                change({ from: undefined, to: undefined });
              }}
            >
              Whole flight
            </Button>
            <Button
              variant="default"
              disabled={window === undefined}
              onClick={() => {
                if (window === undefined) return;
                const more = 0.25 * (window[1] - window[0]);
                change({ from: window[0] - more, to: window[1] + more });
              }}
            >
              Widen
            </Button>
          </Group>
        }
      >
        <div className="split">
          <Stack gap="md">
            <CutForm
              flightId={flight.id}
              window={window}
              label={view.label}
              fta={view.fta}
              onWindow={(next) => {
                change({ from: next[0], to: next[1] });
              }}
            />
            <ChannelPicker
              label="Channels"
              groups={byRole(channels)}
              value={shown}
              height={260}
              onChange={(names) => {
                change({ channels: names });
              }}
            />
          </Stack>
          {shown.length === 0 ? (
            <Empty title="No channel selected">Select one or more on the left.</Empty>
          ) : (
            <Figure
              kind="flight-history"
              title="Recording"
              params={{
                flight_id: flight.id,
                channels: shown,
                start_s: view.from,
                stop_s: view.to,
              }}
              revision={[shown, view.from, view.to].join()}
              onWindow={(next) => {
                change({ from: next?.[0], to: next?.[1] });
              }}
            />
          )}
        </div>
      </Section>
    </>
  );
}

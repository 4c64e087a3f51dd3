import { Stack, Tabs, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link, useLocation } from "@tanstack/react-router";
import { useEffect, useRef } from "react";
import { aircraftQuery, modalTablesQuery, predictionsQuery } from "../api/queries";
import type { Aircraft, Prediction } from "../api/types";
import { ButtonLink } from "../components/controls/ButtonLink";
import { Facts } from "../components/display/ConditionFacts";
import { ComputePrediction } from "../components/predictions/ComputePrediction";
import { DataTable, numeric } from "../components/controls/DataTable";
import { Empty } from "../components/display/Empty";
import { LatticeSection } from "../components/predictions/LatticeSection";
import { Loaded } from "../components/display/Loaded";
import { ModalTableView } from "../components/predictions/ModalTableView";
import { quantity } from "../components/display/Quantity";
import { PageHead } from "../components/frame/PageHead";
import { Section } from "../components/display/Section";
import { ThrustSection } from "../components/maneuvers/ThrustSection";
import { fixed, percent } from "../lib/text/format";
import { someFuels } from "../lib/modes";

const route = getRouteApi("/aircraft");

/** Data of the aircraft: mass, sensors, modes, predictions. */
export function AircraftPage() {
  const { id } = route.useSearch();
  const navigate = route.useNavigate();
  const aircraft = useQuery(aircraftQuery);
  return (
    <>
      <PageHead
        title="Aircraft"
        actions={
          <ButtonLink to="/aircraft/new" variant="default">
            New aircraft
          </ButtonLink>
        }
        trail={[
          <Link to="/campaign" className="link" key="campaign">
            Campaign
          </Link>,
        ]}
      />
      <Loaded query={aircraft}>
        {(all) => {
          const [first] = all;
          if (first === undefined) {
            return (
              <Empty title="No aircraft yet">
                Import recorded data, add a new aircraft, or run <code>flexsid demo</code>.
              </Empty>
            );
          }
          return all.length === 1 ? (
            <OneAircraft aircraft={first} />
          ) : (
            <Tabs
              value={String((all.find((one) => one.id === id) ?? first).id)}
              onChange={(selected) => {
                void navigate({ search: { id: Number(selected) }, replace: true });
              }}
            >
              <Tabs.List mb="md">
                {all.map((one) => (
                  <Tabs.Tab key={one.id} value={String(one.id)}>
                    {one.name}
                  </Tabs.Tab>
                ))}
              </Tabs.List>
              {all.map((one) => (
                <Tabs.Panel key={one.id} value={String(one.id)}>
                  <OneAircraft aircraft={one} />
                </Tabs.Panel>
              ))}
            </Tabs>
          );
        }}
      </Loaded>
    </>
  );
}

function OneAircraft({ aircraft }: { aircraft: Aircraft }) {
  const tables = useQuery(modalTablesQuery(aircraft.id));
  const predictions = useQuery(predictionsQuery(aircraft.id));
  const { geometry, mass, flutter } = aircraft;
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const shown = predictions.data?.find((one) => one.id === view.prediction);
  const predictionsPanel = useRef<HTMLDivElement>(null);
  const { hash } = useLocation();
  useEffect(() => {
    if (hash === "predictions") predictionsPanel.current?.scrollIntoView();
  }, [hash, predictions.isSuccess]);
  return (
    <Stack gap="md">
      <Section title={aircraft.name} note={aircraft.description}>
        <Facts
          facts={[
            ["Wing area", fixed(geometry.area_m2, 3), "m²"],
            ["Mean chord", fixed(geometry.chord_m, 3), "m"],
            ["Span", fixed(geometry.span_m, 2), "m"],
            ["Surfaces", aircraft.surfaces.length],
            ["Sensors", aircraft.sensors.length],
          ]}
        />
        <div style={{ maxWidth: 640, marginTop: 12 }}>
          <DataTable
            label="Mass properties"
            columns={[
              numeric("fuel", "Fuel", (row: number) => percent(mass.fuel[row]), "%"),
              quantity("mass", "Mass", (row: number) => mass.mass_kg[row], "kg", 2),
              quantity(
                "inertia",
                "Pitch inertia",
                (row: number) => mass.pitch_inertia_kg_m2[row],
                "kg*m2",
                2,
              ),
              quantity("cg", "x c.g.", (row: number) => mass.x_cg_m[row], "m", 4),
              ...(flutter
                ? [
                    quantity(
                      "flutter",
                      "Flutter speed",
                      (row: number) =>
                        flutter.speed_m_s[flutter.fuel.indexOf(mass.fuel[row] ?? NaN)],
                      "m/s",
                      1,
                    ),
                  ]
                : []),
            ]}
            rows={someFuels(mass.fuel)}
            rowKey={(row) => row}
          />
        </div>
      </Section>
      <ThrustSection aircraft={aircraft} />
      <div id="predictions" ref={predictionsPanel}>
        <Section title="Predictions" note="Derivatives from sources other than flight">
          <ComputePrediction aircraft={aircraft} />
          <Loaded query={predictions}>
            {(all) =>
              all.length === 0 ? (
                <Text size="sm" className="quiet">
                  None stored
                </Text>
              ) : (
                <DataTable
                  label="Predictions"
                  columns={[
                    { key: "source", header: "Source", render: (one) => one.source },
                    { key: "kind", header: "Kind", render: (one) => one.kind },
                    {
                      key: "n",
                      header: "Derivatives",
                      numeric: true,
                      render: (one) => one.names.length,
                    },
                    {
                      key: "fuel",
                      header: "Fuel",
                      unit: "%",
                      numeric: true,
                      render: (one) =>
                        [...new Set([one.fuel[0], one.fuel.at(-1)])]
                          .map((fuel) => percent(fuel))
                          .join(" to "),
                    },
                    numeric("k", "Reference k", (one: Prediction) =>
                      one.unsteady ? fixed(one.unsteady.reference_k, 2) : "",
                    ),
                    { key: "note", header: "Note", wraps: true, render: (one) => one.note },
                    {
                      key: "lattice",
                      header: "Lattice",
                      render: (one) =>
                        one.unsteady?.lattice && (
                          <Link
                            to="/aircraft"
                            search={{ id: aircraft.id, prediction: one.id }}
                            className="link"
                          >
                            Lattice
                          </Link>
                        ),
                    },
                    {
                      key: "flutter",
                      header: "Flutter",
                      render: (one) =>
                        one.names.some((name) => name.startsWith("CQ")) && (
                          <Link to="/flutter" search={{ prediction: one.id }} className="link">
                            Flutter
                          </Link>
                        ),
                    },
                  ]}
                  rows={all}
                  rowKey={(one) => one.id}
                />
              )
            }
          </Loaded>
        </Section>
      </div>
      {shown && (
        <LatticeSection
          prediction={shown}
          view={view}
          onChange={(change) =>
            void navigate({
              search: (previous) => ({ ...previous, ...change }),
              replace: true,
            })
          }
        />
      )}
      <Loaded query={tables}>
        {(all) =>
          all.length === 0 ? (
            <Empty title="No modal table stored" />
          ) : (
            all.map((table) => <ModalTableView key={table.id} table={table} />)
          )
        }
      </Loaded>
    </Stack>
  );
}

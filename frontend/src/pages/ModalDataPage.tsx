import { Group, Select, Slider, Spoiler, Stack, Tabs, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { aircraftQuery, modalTablesQuery } from "../api/queries";
import type { Aircraft, ModalTable } from "../api/types";
import { Empty } from "../components/display/Empty";
import { Loaded } from "../components/display/Loaded";
import { ModalAssuranceTab } from "../components/modes/ModalAssuranceTab";
import { FlutterTab } from "../components/modes/FlutterTab";
import { FuelTab } from "../components/modes/FuelTab";
import { OrderTab } from "../components/modes/OrderTab";
import { ModeSensorsTab } from "../components/modes/ModeSensorsTab";
import { ShapesTab } from "../components/modes/ShapesTab";
import { ModalFiles } from "../components/modes/ModalFiles";
import { tableTitle, type TableProps } from "../components/modes/tables";
import { VibrationTab } from "../components/modes/VibrationTab";
import { NotesButton } from "../components/display/Notes";
import { PageHead } from "../components/frame/PageHead";
import { MODAL_TABS, type ModalDataView } from "../views";

const route = getRouteApi("/modal-data");

const TITLES: Record<(typeof MODAL_TABS)[number], string> = {
  fuel: "Over fuel",
  shapes: "Shapes",
  mac: "MAC and correlation",
  sensors: "Sensors",
  order: "Model order",
  gvt: "Ground vibration test",
  flutter: "Flutter summaries",
  files: "Import",
};

/** Modal data of FEM and GVT: over fuel, shapes, correlation, observability, model order. */
export function ModalDataPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const fleet = useQuery(aircraftQuery);
  const change = (part: Partial<ModalDataView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }), replace: true });
  return (
    <>
      <PageHead
        title="Modal data"
        trail={[
          <Link to="/aircraft" className="link" key="aircraft">
            Aircraft
          </Link>,
        ]}
      />
      <Loaded query={fleet} rows={8}>
        {(aircraft) => {
          const selected = aircraft.find((one) => one.id === view.aircraft) ?? aircraft[0];
          return selected === undefined ? (
            <Empty title="No aircraft yet">Import a maneuver or a mapping first.</Empty>
          ) : (
            <OneAircraft all={aircraft} aircraft={selected} view={view} onChange={change} />
          );
        }}
      </Loaded>
    </>
  );
}

interface Props {
  all: Aircraft[];
  aircraft: Aircraft;
  view: ModalDataView;
  onChange: (change: Partial<ModalDataView>) => void;
}

function OneAircraft({ all, aircraft, view, onChange }: Props) {
  const tables = useQuery(modalTablesQuery(aircraft.id));
  return (
    <Loaded query={tables} rows={8}>
      {(known) => {
        const usable = known.filter((table) => "omega" in table.arrays);
        const table =
          usable.find((one) => one.id === view.table) ??
          usable.filter((one) => one.kind === "FEM").at(-1) ??
          usable[0];
        const tab = view.tab ?? (table === undefined ? "files" : "fuel");
        return (
          <Stack gap="md">
            <Group justify="space-between" align="flex-end">
              <Choices {...{ all, aircraft, view, onChange, usable, table }} />
              <NotesButton
                filter={{ aircraft_id: aircraft.id }}
                subject="mode"
                topics={[...new Set(known.flatMap((one) => one.numbers))]
                  .toSorted((one, other) => one - other)
                  .map((mode) => ({
                    subject: "mode",
                    key: String(mode),
                    aircraft_id: aircraft.id,
                    label: `Mode ${mode}`,
                  }))}
              />
            </Group>
            <Tabs
              value={tab}
              onChange={(value) => {
                onChange({ tab: MODAL_TABS.find((one) => one === value) });
              }}
              keepMounted={false}
            >
              <Tabs.List mb="md">
                {MODAL_TABS.map((one) => (
                  <Tabs.Tab value={one} key={one}>
                    {TITLES[one]}
                  </Tabs.Tab>
                ))}
              </Tabs.List>
              <Tabs.Panel value="files">
                <ModalFiles aircraft={aircraft} view={view} onChange={onChange} />
              </Tabs.Panel>
              <Tabs.Panel value="gvt">
                <VibrationTab {...{ aircraft, usable, view, onChange }} />
              </Tabs.Panel>
              <Tabs.Panel value="flutter">
                <FlutterTab {...{ aircraft, table, view, onChange }} />
              </Tabs.Panel>
              {table === undefined ? (
                tab !== "files" &&
                tab !== "flutter" &&
                tab !== "gvt" && (
                  <Empty title="No modal data yet">
                    Import the output of a FEM (.op2, .f06, .pch with its deck) or of a ground
                    vibration test (.uff, .unv).
                  </Empty>
                )
              ) : (
                <TablePanels {...{ aircraft, table, usable, view, onChange }} />
              )}
            </Tabs>
          </Stack>
        );
      }}
    </Loaded>
  );
}

function TablePanels(props: TableProps) {
  return (
    <>
      <Tabs.Panel value="fuel">
        <FuelTab {...props} />
      </Tabs.Panel>
      <Tabs.Panel value="shapes">
        <ShapesTab {...props} />
      </Tabs.Panel>
      <Tabs.Panel value="mac">
        <ModalAssuranceTab {...props} />
      </Tabs.Panel>
      <Tabs.Panel value="sensors">
        <ModeSensorsTab {...props} />
      </Tabs.Panel>
      <Tabs.Panel value="order">
        <OrderTab {...props} />
      </Tabs.Panel>
    </>
  );
}

interface ChoicesProps extends Props {
  usable: ModalTable[];
  table: ModalTable | undefined;
}

function Choices({ all, aircraft, view, onChange, usable, table }: ChoicesProps) {
  return (
    <Group align="end" gap="lg">
      {all.length > 1 && (
        <Select
          label="Aircraft"
          allowDeselect={false}
          data={all.map((one) => ({ value: String(one.id), label: one.name }))}
          value={String(aircraft.id)}
          onChange={(value) => {
            onChange({ aircraft: Number(value), table: undefined, mode: undefined });
          }}
        />
      )}
      <Select
        label="Modal table"
        w={280}
        allowDeselect={false}
        data-testid="modal-table"
        data={usable.map((one) => ({ value: String(one.id), label: tableTitle(one) }))}
        value={table === undefined ? null : String(table.id)}
        onChange={(value) => {
          onChange({ table: Number(value), mode: undefined });
        }}
      />
      <div style={{ width: 260 }}>
        <Text size="sm" fw={500} id="fuel-label">
          Fuel [%]: {view.fuel ?? 50}
        </Text>
        <Slider
          aria-labelledby="fuel-label"
          thumbLabel="Fuel in percent"
          defaultValue={view.fuel ?? 50}
          min={0}
          max={100}
          label={null}
          onChangeEnd={(fuel) => {
            onChange({ fuel });
          }}
        />
      </div>
      {table !== undefined && (
        <Spoiler maxHeight={56} showLabel="Show all notes" hideLabel="Hide notes" maw={420} fz="xs">
          <Text size="xs" className="quiet">
            {[table.origin, ...table.notes].filter(Boolean).join(" · ")}
          </Text>
        </Spoiler>
      )}
    </Group>
  );
}

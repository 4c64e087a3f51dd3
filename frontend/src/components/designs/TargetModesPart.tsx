import { Alert, Group, Select } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { aircraftQuery, targetModesQuery } from "../../api/queries";
import type { Design, TargetMode } from "../../api/types";
import { fixed } from "../../lib/text/format";
import { DataTable, type Column } from "../controls/DataTable";
import { Empty } from "../display/Empty";
import { Loaded } from "../display/Loaded";
import { NumberField } from "../controls/NumberField";
import { Quantity, quantity, UnitName } from "../display/Quantity";
import { Section } from "../display/Section";

const COLUMNS: Column<TargetMode>[] = [
  { key: "name", header: "Mode", render: (mode) => mode.name },
  { key: "group", header: "Target", render: (mode) => mode.group },
  quantity("frequency", "Frequency", (mode) => mode.frequency_hz, "Hz", 2),
  {
    key: "damping",
    header: "Damping ratio",
    numeric: true,
    render: (mode) => fixed(mode.damping, 3),
  },
  {
    key: "about",
    header: "Band about it",
    unit: <UnitName unit="Hz" />,
    numeric: true,
    render: (mode) => (
      <>
        <Quantity value={mode.low_hz} unit="Hz" decimals={2} />–
        <Quantity value={mode.high_hz} unit="Hz" decimals={2} />
      </>
    ),
  },
  {
    key: "harmonics",
    header: "Harmonics per surface",
    numeric: true,
    render: (mode) => mode.harmonics_per_surface,
  },
  { key: "band", header: "In the band", render: (mode) => (mode.in_band ? "yes" : "no") },
];

const LEAST_HARMONICS = 3;
const isShort = (mode: TargetMode) => !mode.in_band || mode.harmonics_per_surface < LEAST_HARMONICS;

interface Props {
  design: Design;
  /** Aircraft of the modes; the first one where undefined. */
  aircraft: number | undefined;
  /** Airspeed of the modes [m/s]; in vacuo where undefined. */
  airspeed: number | undefined;
  onChange: (part: { aircraft?: number | undefined; airspeed?: number | undefined }) => void;
}

/** The harmonics of a design about the modes that it is to excite. */
export function TargetModesPart({ design, aircraft, airspeed, onChange }: Props) {
  const known = useQuery(aircraftQuery);
  const selected = aircraft ?? known.data?.[0]?.id;
  const targets = useQuery(targetModesQuery(design.id, selected, airspeed));
  return (
    <Section
      title="Target modes"
      note={
        airspeed === undefined
          ? "Structural modes in vacuo, over all fuel weights; with an airspeed those in flight"
          : "In flight at sea level and half fuel, by the predictions of the aircraft"
      }
    >
      {known.data?.length === 0 ? (
        <Empty title="No aircraft">Import an aircraft with its modal table first.</Empty>
      ) : (
        <>
          <Group mb="sm" align="end">
            <Select
              label="Aircraft"
              w={300}
              allowDeselect={false}
              data={(known.data ?? []).map((one) => ({ value: String(one.id), label: one.name }))}
              value={selected === undefined ? null : String(selected)}
              onChange={(id) => {
                onChange({ aircraft: id === null ? undefined : Number(id) });
              }}
            />
            <NumberField
              label="Airspeed"
              unit="m/s"
              placeholder="in vacuo"
              w={150}
              isPositive
              value={airspeed}
              onChange={(next) => {
                onChange({ airspeed: next });
              }}
            />
          </Group>
          <Loaded query={targets} rows={4}>
            {(found) => (
              <>
                {design.fta !== null && found.modes.some(isShort) ? (
                  <Alert color="orange" mb="sm">
                    {found.sentence}
                  </Alert>
                ) : (
                  <p className="quiet">{found.sentence}</p>
                )}
                <DataTable
                  label="Target modes"
                  testId="target-modes"
                  columns={COLUMNS}
                  rows={found.modes}
                  rowKey={(mode) => mode.number ?? mode.name}
                  isSelected={isShort}
                />
              </>
            )}
          </Loaded>
        </>
      )}
    </Section>
  );
}

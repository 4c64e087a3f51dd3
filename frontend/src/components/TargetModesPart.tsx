import { Alert, Select } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { aircraftQuery, targetModesQuery } from "../api/queries";
import type { Design, TargetMode } from "../api/types";
import { fixed } from "../lib/format";
import { DataTable, type Column } from "./DataTable";
import { Empty } from "./Empty";
import { Loaded } from "./Loaded";
import { Section } from "./Section";

const COLUMNS: Column<TargetMode>[] = [
  { key: "name", header: "Mode", render: (mode) => mode.name },
  { key: "group", header: "Target", render: (mode) => mode.group },
  {
    key: "frequency",
    header: "Frequency in vacuo",
    unit: "Hz",
    numeric: true,
    render: (mode) =>
      fixed(mode.low_hz, 2) === fixed(mode.high_hz, 2)
        ? fixed(mode.low_hz, 2)
        : `${fixed(mode.low_hz, 2)}–${fixed(mode.high_hz, 2)}`,
  },
  { key: "band", header: "In the band", render: (mode) => (mode.in_band ? "yes" : "no") },
];

interface Props {
  design: Design;
  /** Aircraft of the modes; the first one where undefined. */
  aircraft: number | undefined;
  onChange: (aircraft: number | undefined) => void;
}

/** The band of a design against the structural modes that it is to excite. */
export function TargetModesPart({ design, aircraft, onChange }: Props) {
  const known = useQuery(aircraftQuery);
  const selected = aircraft ?? known.data?.[0]?.id;
  const targets = useQuery(targetModesQuery(design.id, selected));
  return (
    <Section title="Target modes" note="Frequencies of the modal table, over all fuel weights">
      {known.data?.length === 0 ? (
        <Empty title="No aircraft">Import an aircraft with its modal table first.</Empty>
      ) : (
        <>
          <Select
            label="Aircraft"
            mb="sm"
            w={300}
            allowDeselect={false}
            data={(known.data ?? []).map((one) => ({ value: String(one.id), label: one.name }))}
            value={selected === undefined ? null : String(selected)}
            onChange={(id) => {
              onChange(id === null ? undefined : Number(id));
            }}
          />
          <Loaded query={targets} rows={4}>
            {(found) => (
              <>
                {design.fta !== null && found.modes.some((mode) => !mode.in_band) ? (
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
                  rowKey={(mode) => mode.number}
                  isSelected={(mode) => !mode.in_band}
                />
              </>
            )}
          </Loaded>
        </>
      )}
    </Section>
  );
}

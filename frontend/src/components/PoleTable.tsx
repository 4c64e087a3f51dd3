import type { Pole } from "../api/types";
import { fixed, hertz } from "../lib/format";
import { oscillation, upperHalf } from "../lib/poles";
import { DataTable, type Column } from "./DataTable";

const columns: Column<Pole>[] = [
  { key: "name", header: "Mode", render: (pole) => pole.name || "–" },
  {
    key: "hertz",
    header: "Frequency",
    unit: "Hz",
    numeric: true,
    render: (pole) => fixed(hertz(oscillation(pole).omega), 3),
  },
  {
    key: "omega",
    header: "Frequency",
    unit: "rad/s",
    numeric: true,
    render: (pole) => fixed(oscillation(pole).omega, 2),
  },
  {
    key: "omega-std",
    header: "σ",
    unit: "rad/s",
    numeric: true,
    render: (pole) => fixed(oscillation(pole).omegaStd, 2),
  },
  {
    key: "damping",
    header: "Damping ratio",
    numeric: true,
    render: (pole) => fixed(oscillation(pole).damping, 4),
  },
  {
    key: "damping-std",
    header: "σ",
    numeric: true,
    render: (pole) => fixed(oscillation(pole).dampingStd, 4),
  },
  {
    key: "real",
    header: "Real",
    unit: "1/s",
    numeric: true,
    render: (pole) => fixed(pole.real, 3),
  },
];

/** Eigenvalues of the identified model as frequency and damping. */
export function PoleTable({ poles }: { poles: Pole[] }) {
  return (
    <DataTable
      label="Poles"
      testId="pole-table"
      columns={columns}
      rows={upperHalf(poles)}
      rowKey={(pole) => `${pole.real} ${pole.imag}`}
    />
  );
}

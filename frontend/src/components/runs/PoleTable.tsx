import type { Pole } from "../../api/types";
import { useConversion, useDisplayUnits } from "../../api/units";
import { fixed, hertz, withError } from "../../lib/text/format";
import { oscillation, upperHalf } from "../../lib/poles";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { UnitName } from "../display/Quantity";

/** The server's figures with their errors; without them those of the eigenvalue alone. */
function known(pole: Pole) {
  const own = oscillation(pole);
  const omega = pole.frequency ?? own.omega;
  const omegaStd = pole.frequency_std ?? own.omegaStd;
  return {
    omega,
    hertz: hertz(omega),
    hertzStd: omegaStd === null ? null : hertz(omegaStd),
    damping: pole.damping ?? own.damping,
    dampingStd: pole.damping_std ?? own.dampingStd,
  };
}

/** A value with two standard errors, as figures show them. */
function WithError({ value, sigma }: { value: number; sigma: number | null }) {
  const shown = withError(value, sigma === null ? null : 2 * sigma);
  return (
    <span style={{ whiteSpace: "nowrap" }}>
      {shown.value}
      {sigma !== null && <span className="quiet"> ± {shown.error}</span>}
    </span>
  );
}

function Frequency({ pole }: { pole: Pole }) {
  const { hertz: value, hertzStd: std } = known(pole);
  const { factor } = useConversion()("Hz");
  return <WithError value={factor * value} sigma={std === null ? null : factor * std} />;
}

const columns: Column<Pole>[] = [
  { key: "name", header: "Mode", render: (pole) => pole.name || "–" },
  {
    key: "hertz",
    header: "Frequency ±2σ",
    unit: <UnitName unit="Hz" />,
    numeric: true,
    render: (pole) => <Frequency pole={pole} />,
  },
  numeric("omega", "Frequency", (pole) => fixed(known(pole).omega, 2), "rad/s"),
  {
    key: "damping",
    header: "Damping ratio ±2σ",
    numeric: true,
    render: (pole) => <WithError value={known(pole).damping} sigma={known(pole).dampingStd} />,
  },
  numeric("real", "Real", (pole) => fixed(pole.real, 3), "1/s"),
];

/** Eigenvalues of the identified model as frequency and damping. */
export function PoleTable({ poles }: { poles: Pole[] }) {
  const { frequency_unit: unit } = useDisplayUnits();
  return (
    <DataTable
      label="Poles"
      testId="pole-table"
      columns={unit === "Hz" ? columns : columns.filter((one) => one.key !== "omega")}
      rows={upperHalf(poles)}
      rowKey={(pole) => `${pole.real} ${pole.imag}`}
    />
  );
}

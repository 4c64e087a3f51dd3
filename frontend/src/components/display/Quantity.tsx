import type { ReactNode } from "react";
import { useConversion } from "../../api/units";
import { converted, fixed } from "../../lib/text/format";
import type { Column } from "../controls/DataTable";

type Maybe = number | null | undefined;

interface Props {
  /** In SI, or in Hz. */
  value: Maybe;
  unit: string;
  /** Decimals of the SI value; the displayed value has about the same resolution. */
  decimals: number;
  /** Followed by its unit. */
  named?: boolean;
}

/** A physical quantity in the display unit. */
export function Quantity({ value, unit, decimals, named }: Props) {
  const { name, factor } = useConversion()(unit);
  const shown = converted(value, factor, decimals);
  return <>{named === true ? `${shown} ${name}` : shown}</>;
}

/** A band of frequencies in the display unit. */
export function Band({ hz }: { hz: readonly number[] }) {
  return (
    <>
      <Quantity value={hz[0]} unit="Hz" decimals={2} /> to{" "}
      <Quantity value={hz[1]} unit="Hz" decimals={2} named />
    </>
  );
}

/** Name of the display unit of an SI unit, or of Hz. */
export function UnitName({ unit }: { unit: string }) {
  return <>{useConversion()(unit).name}</>;
}

/** An estimate with two standard errors in the display unit. */
export function WithInterval({ value, std, unit, decimals }: Props & { std: Maybe }) {
  const { factor } = useConversion()(unit);
  const spread = std == null ? fixed(null, 0) : converted(2 * std, factor, decimals);
  return (
    <>
      {converted(value, factor, decimals)} ± {spread}
    </>
  );
}

const QUANTITIES = /(\d+(?:\.\d+)?)(?:( ± | to | and )(\d+(?:\.\d+)?))? (m\/s(?![²2])|Hz)/g;

/** A sentence of the server, e.g. "at 59.0 ± 2.2 m/s", with airspeeds and Hz in display units. */
export function Sentence({ text }: { text: string }) {
  const conversion = useConversion();
  const inUnits = (
    whole: string,
    first: string,
    joint: string | undefined,
    second: string | undefined,
    unit: string,
  ) => {
    const { name, factor } = conversion(unit);
    const convert = (number: string) =>
      fixed(factor * Number(number), number.split(".")[1]?.length ?? 0);
    if (factor === 1) return whole;
    return `${convert(first)}${joint && second ? joint + convert(second) : ""} ${name}`;
  };
  return <>{text.replace(QUANTITIES, inUnits)}</>;
}

/** A column of a physical quantity. */
export function quantity<Row>(
  key: string,
  header: ReactNode,
  value: (row: Row) => Maybe,
  unit: string,
  decimals: number,
): Column<Row> {
  return {
    key,
    header,
    unit: <UnitName unit={unit} />,
    numeric: true,
    render: (row) => <Quantity value={value(row)} unit={unit} decimals={decimals} />,
  };
}

/** A physical quantity among facts: label, value and unit. */
export const quantityFact = (
  label: ReactNode,
  value: Maybe,
  unit: string,
  decimals: number,
): [ReactNode, ReactNode, ReactNode] => [
  label,
  <Quantity key="value" value={value} unit={unit} decimals={decimals} />,
  <UnitName key="unit" unit={unit} />,
];

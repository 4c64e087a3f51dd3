import { NumberInput, type NumberInputProps } from "@mantine/core";
import { useState } from "react";
import { useConversion } from "../../api/units";

const DIGITS = 12; // fewer than a number has, so that conversions do not show their rounding

interface Props extends Omit<
  NumberInputProps,
  "value" | "onChange" | "label" | "min" | "max" | "step"
> {
  label?: string;
  /** Unit of the value and of its bounds; the field shows and takes its display unit. */
  unit?: string;
  value: number | null | undefined;
  /** Receives undefined where nothing, no number, or not a positive one is typed. */
  onChange: (value: number | undefined) => void;
  min?: number;
  max?: number;
  step?: number;
  isPositive?: boolean;
}

/**
 * A field of a number. What is typed stays until the field is left: "0." and "1.50" are on the
 * way to a number, and a field that showed its value meanwhile would lose their last digits.
 */
export function NumberField(props: Props) {
  const { label, unit, value, onChange, min, max, step, isPositive, onBlur, ...others } = props;
  const [typed, setTyped] = useState<string | number>();
  const convert = useConversion();
  const { name, factor } = unit === undefined ? { name: "", factor: 1 } : convert(unit);
  const show = (one: number) => Number((one * factor).toPrecision(DIGITS));
  const bounds = Object.fromEntries(
    Object.entries({ min, max, step }).flatMap(([key, one]) =>
      one === undefined ? [] : [[key, show(one)]],
    ),
  );
  return (
    <NumberInput
      {...others}
      {...bounds}
      label={unit === undefined || label === undefined ? label : `${label} [${name}]`}
      value={typed ?? (value == null ? "" : show(value))}
      onChange={(next) => {
        setTyped(next);
        onChange(read(next, factor, isPositive === true));
      }}
      onBlur={(event) => {
        setTyped(undefined);
        onBlur?.(event);
      }}
    />
  );
}

/** The value of a text in the display unit. */
function read(text: string | number, factor: number, isPositive: boolean): number | undefined {
  const shown = typeof text === "string" && text.trim() === "" ? NaN : Number(text);
  if (!Number.isFinite(shown) || (isPositive && shown <= 0)) return undefined;
  return factor === 1 ? shown : Number((shown / factor).toPrecision(DIGITS));
}

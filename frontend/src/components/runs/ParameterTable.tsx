import { Text } from "@mantine/core";
import type { Parameter } from "../../api/types";
import { fixed, relativeError, significant, withError } from "../../lib/format";
import { DataTable, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { UnitOf } from "../display/UnitOf";

/** Without a standard error, or less than two away from zero: its sign is not known. */
const isWeak = (parameter: Parameter): boolean =>
  parameter.std_error == null || isNearZero(parameter);

const isNearZero = (parameter: Parameter): boolean =>
  parameter.std_error != null && Math.abs(parameter.value) < 2 * parameter.std_error;

const nameColumn = (names: readonly string[]): Column<Parameter> => ({
  key: "name",
  header: "Parameter",
  sort: "name",
  render: (one) => (
    <>
      <DerivativeName name={one.name} />
      <UnitOf name={one.name} among={names} />
    </>
  ),
});

const NUMBERS: Column<Parameter>[] = [
  {
    key: "value",
    header: "Value",
    numeric: true,
    sort: "value",
    render: (one) => withError(one.value, one.std_error).value,
  },
  {
    key: "error",
    header: "σ",
    help: "std_error",
    numeric: true,
    sort: "std_error",
    render: (one) => withError(one.value, one.std_error).error,
  },
  {
    key: "relative",
    header: "σ",
    unit: "%",
    numeric: true,
    sort: "relative",
    render: (one) => significant(relativeError(one.value, one.std_error), 2),
  },
  {
    key: "bound",
    header: "Cramér-Rao",
    help: "Cramér-Rao",
    numeric: true,
    render: (one) => significant(one.cramer_rao, 2),
  },
  {
    key: "insensitivity",
    header: "Insensitivity",
    help: "Insensitivity",
    numeric: true,
    render: (one) => significant(one.insensitivity, 2),
  },
  {
    key: "start",
    header: "Start",
    help: "Start",
    numeric: true,
    render: (one) => significant(one.start),
  },
  {
    key: "change",
    header: "Change",
    help: "Change",
    unit: "σ",
    numeric: true,
    render: (one) =>
      one.start == null || one.std_error == null || one.std_error === 0
        ? "–"
        : fixed((one.value - one.start) / one.std_error, 1),
  },
  {
    key: "flag",
    header: "",
    render: (one) =>
      isWeak(one) && (
        <Text
          span
          size="xs"
          c="var(--page-warn)"
          title={
            one.std_error == null
              ? "No standard error is known: see the warnings of the fit"
              : "Not distinguishable from zero: |value| < 2σ"
          }
        >
          {one.std_error == null ? (one.no_error ?? "no σ") : "< 2σ"}
        </Text>
      ),
  },
];

/** Share of the variance that is due to noise. */
const noiseColumn = (share: Record<string, number>): Column<Parameter> => ({
  key: "noise",
  header: "Noise",
  help: "Noise",
  unit: "%",
  numeric: true,
  onlyIf: (one) => one.name in share,
  render: (one) => (one.name in share ? fixed(100 * (share[one.name] ?? 0), 0) : "–"),
});

/** Share of the variance that is due to the frequencies and damping of the modal table. */
const MODAL: Column<Parameter> = {
  key: "modal",
  header: (
    <span title="Share of σ² due to the frequencies and damping of the modal table">
      Modal table
    </span>
  ),
  unit: "%",
  numeric: true,
  onlyIf: (one) => one.modal_std != null,
  render: ({ modal_std, std_error }) =>
    modal_std == null || !std_error ? "–" : fixed(100 * (modal_std / std_error) ** 2, 0),
};

const KEYS: Record<string, (one: Parameter) => number | string> = {
  name: (one) => one.name,
  value: (one) => one.value,
  std_error: (one) => one.std_error ?? Infinity,
  relative: (one) => relativeError(one.value, one.std_error) ?? Infinity,
};

function sortParameters(parameters: Parameter[], sort: string | undefined): Parameter[] {
  const key = KEYS[sort?.replace(/^-/, "") ?? ""];
  if (key === undefined) return parameters; // the model's own order
  const sign = sort?.startsWith("-") === true ? -1 : 1;
  return [...parameters].sort((a, b) => {
    const [x, y] = [key(a), key(b)];
    return sign * (x < y ? -1 : x > y ? 1 : 0);
  });
}

interface Props {
  parameters: Parameter[];
  noiseShare?: Record<string, number>;
  sort: string | undefined;
  onSort: (sort: string) => void;
}

/** Estimates with their standard errors. */
export function ParameterTable({ parameters, noiseShare = {}, sort, onSort }: Props) {
  const near = parameters.filter(isNearZero).length;
  const without = parameters.filter((one) => one.std_error == null).length;
  return (
    <>
      <DataTable
        label="Parameters"
        testId="parameter-table"
        columns={[
          nameColumn(parameters.map((one) => one.name)),
          ...NUMBERS.slice(0, 3),
          noiseColumn(noiseShare),
          MODAL,
          ...NUMBERS.slice(3),
        ]}
        rows={sortParameters(parameters, sort)}
        rowKey={(one) => one.name}
        sort={sort}
        onSort={onSort}
      />
      <Text size="xs" className="quiet numbers" p="xs">
        {parameters.length} parameters, {near} of them within 2σ of zero
        {without > 0 && `, ${without} without standard error`}
      </Text>
    </>
  );
}

import { Text } from "@mantine/core";
import type { Parameter } from "../../api/types";
import { fixed, relativeError, significant, withError } from "../../lib/text/format";
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

type Shares = NonNullable<Parameter["shares"]>;

const CAUSES: readonly [keyof Shares, string, string][] = [
  ["noise", "Noise", "the noise of the record"],
  ["prediction", "Prediction", "predicted derivatives, most of them of retained modes"],
  ["mode_shapes", "Mode shapes", "the mode shapes at the sensors"],
  ["modal_table", "Modal table", "the frequencies and damping of the modal table"],
  ["mass", "Mass", "mass and inertia"],
  ["condition", "Condition", "airspeed and density"],
];
const SHOWN = 0.005;

/** Share of the variance due to a cause; noise and modal table are known of earlier runs, too. */
function shareOf(
  one: Parameter,
  cause: keyof Shares,
  noiseShare: Record<string, number>,
): number | undefined {
  if (one.shares != null) return one.shares[cause];
  if (cause === "noise") return noiseShare[one.name];
  if (cause !== "modal_table" || one.modal_std == null || !one.std_error) return undefined;
  return (one.modal_std / one.std_error) ** 2;
}

/** Shares of the variance by the causes that any parameter has. */
const shareColumns = (noiseShare: Record<string, number>): Column<Parameter>[] =>
  CAUSES.map(([cause, header, meaning]) => ({
    key: cause,
    header: <span title={`Share of σ² due to ${meaning}`}>{header}</span>,
    ...(cause === "noise" && { header, help: "Noise" }),
    unit: "%",
    numeric: true,
    onlyIf: (one) => (shareOf(one, cause, noiseShare) ?? 0) >= SHOWN,
    render: (one) => {
      const share = shareOf(one, cause, noiseShare);
      return share === undefined ? "–" : fixed(100 * share, 0);
    },
  }));

/** What estimates from other flights differ by. */
const REPEATABILITY: Column<Parameter> = {
  key: "repeatability",
  header: "Repeatability",
  help: "Repeatability",
  numeric: true,
  onlyIf: (one) => one.shares != null,
  render: ({ std_error, shares }) =>
    std_error == null || shares == null ? "–" : significant(std_error * Math.sqrt(shares.noise), 2),
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
  const predicted = parameters.filter((one) => (one.shares?.prediction ?? 0) > 0.5).length;
  return (
    <>
      <DataTable
        label="Parameters"
        testId="parameter-table"
        columns={[
          nameColumn(parameters.map((one) => one.name)),
          ...NUMBERS.slice(0, 3),
          REPEATABILITY,
          ...shareColumns(noiseShare),
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
        {predicted > 0 &&
          `, ${predicted} that rest on the prediction for more than half of their variance`}
      </Text>
    </>
  );
}

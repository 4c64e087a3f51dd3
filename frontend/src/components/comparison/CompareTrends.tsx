import { Group, SegmentedControl, Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { trendQuery } from "../../api/queries";
import type { DerivativeTrend } from "../../api/types";
import { fixed, significant, withError } from "../../lib/text/format";
import { AGAINST } from "../../views";
import type { CompareTabProps } from "./CompareDerivatives";
import { DataTable, type Column } from "../controls/DataTable";
import { DerivativeSelect } from "../controls/DerivativeSelect";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { Loaded } from "../display/Loaded";
import { Section } from "../display/Section";

const NAMES: Record<(typeof AGAINST)[number], string> = {
  dynamic_pressure: "Dynamic pressure",
  airspeed_ratio: "V/Vf",
  fuel: "Fuel",
  fta: "FTA",
};

const DEGREES = [
  { value: "0", label: "Constant" },
  { value: "1", label: "Linear" },
  { value: "2", label: "Quadratic" },
];

type Line = DerivativeTrend["lines"][number];

/** Trend of one derivative over the flight conditions, with a weighted fit per method. */
export function CompareTrends({ comparison, view, onChange, onRun }: CompareTabProps) {
  const names = comparison.rows.map((row) => row.name);
  const name = names.find((one) => one === view.derivative) ?? names[0];
  const against = view.against ?? "dynamic_pressure";
  const degree = Math.min(Math.max(view.degree ?? 1, 0), 2);
  if (name === undefined) return <Empty title="No derivatives" />;
  const params = {
    run_ids: view.runs,
    prediction_ids: view.predictions,
    name,
    against,
    degree,
  };
  return (
    <Section
      title="Trend"
      note="Estimates with ±2σ; fits weighted by σ, with a ±2σ band that the scatter widens"
    >
      <Stack gap="sm">
        <Group gap="sm">
          <DerivativeSelect
            names={names}
            value={name}
            onChange={(derivative) => {
              onChange({ derivative });
            }}
          />
          <SegmentedControl
            aria-label="Over"
            data={AGAINST.map((value) => ({ value, label: NAMES[value] }))}
            value={against}
            onChange={(value) => {
              onChange({ against: AGAINST.find((one) => one === value) });
            }}
          />
          {against !== "fta" && (
            <SegmentedControl
              aria-label="Fit"
              data={DEGREES}
              value={String(degree)}
              onChange={(value) => {
                onChange({ degree: Number(value) });
              }}
            />
          )}
        </Group>
        <Figure
          kind="trend"
          title={`${name} over ${NAMES[against].toLowerCase()}`}
          params={params}
          onPick={onRun}
        />
        <Fits
          query={{
            ...params,
            run_ids: (view.runs ?? []).join(","),
            prediction_ids: (view.predictions ?? []).join(",") || undefined,
          }}
        />
      </Stack>
    </Section>
  );
}

function Fits({ query }: { query: Parameters<typeof trendQuery>[0] }) {
  const trend = useQuery(trendQuery(query));
  return (
    <Loaded query={trend} rows={2}>
      {({ lines, unit, against }) => {
        const fits = lines.filter((line) => line.chi_square !== null);
        return fits.length === 0 ? (
          <Empty title="No fit">
            A fit requires two estimates with standard errors by one method.
          </Empty>
        ) : (
          <DataTable
            label="Weighted fits"
            testId="fits-table"
            columns={columnsOf(unit, PER[against])}
            rows={fits}
            rowKey={(line) => line.label}
            isSelected={(line) => (line.probability ?? 1) < 0.05}
          />
        );
      }}
    </Loaded>
  );
}

/** Unit of the slope: a step of the abscissa, and its size in SI. */
const PER: Record<(typeof AGAINST)[number], { step: string; size: number }> = {
  dynamic_pressure: { step: "100 Pa", size: 100 },
  airspeed_ratio: { step: "0.1 V/Vf", size: 0.1 },
  fuel: { step: "10 % fuel", size: 0.1 },
  fta: { step: "FTA", size: 1 },
};

const columnsOf = (unit: string, per: (typeof PER)["fuel"]): Column<Line>[] => [
  { key: "label", header: "Fit", render: (line) => line.label },
  {
    key: "slope",
    header: `Slope ± σ per ${per.step}`,
    unit,
    numeric: true,
    render: (line) => {
      if (line.slope === null) return "–";
      const error = line.slope_std_error === null ? null : per.size * line.slope_std_error;
      const shown = withError(per.size * line.slope, error);
      return `${shown.value} ± ${shown.error}`;
    },
  },
  { key: "chi", header: "χ²", numeric: true, render: (line) => fixed(line.chi_square, 1) },
  { key: "freedom", header: "Degrees of freedom", numeric: true, render: (line) => line.freedom },
  {
    key: "p",
    header: <span title="Probability of a larger scatter by chance">P</span>,
    numeric: true,
    render: (line) => significant(line.probability, 2),
  },
];

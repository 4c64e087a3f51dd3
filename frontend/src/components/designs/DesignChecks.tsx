import { Group } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { designChecksQuery } from "../../api/queries";
import type { Design, DesignChecks } from "../../api/types";
import { fixed } from "../../lib/text/format";
import type { DesignView } from "../../views";
import { DataTable, type Column } from "../controls/DataTable";
import { Loaded } from "../display/Loaded";
import { NumberField } from "../controls/NumberField";
import { quantity } from "../display/Quantity";
import { Section } from "../display/Section";

const RADIAN = 180 / Math.PI;
const ACTUATOR = 60; // rad/s: default, a typical surface actuator

interface PartProps {
  design: Design;
  level: number;
  view: DesignView;
  onChange: (part: Partial<DesignView>) => void;
}

type InputCheck = DesignChecks["inputs"][number];

/** A column in the display unit of surfaces; the full range of throttles is 100 %. */
const motion = (
  key: string,
  header: string,
  value: (row: InputCheck) => number,
  unit: "rad" | "rad/s" | "rad/s2",
  decimals: number,
): Column<InputCheck> => {
  const column = quantity(key, header, value, unit, decimals);
  const suffix = unit.slice("rad".length).replace("2", "²");
  return {
    ...column,
    render: (row) =>
      row.unit === "1" ? `${fixed(100 * value(row), 2)} %${suffix}` : column.render(row),
  };
};

const CHECK_COLUMNS: Column<InputCheck>[] = [
  { key: "name", header: "Input", render: (row) => row.name },
  { key: "rpf", header: "RPF", numeric: true, render: (row) => fixed(row.peak_factor, 3) },
  motion("command", "Command", (row) => row.command_peak, "rad", 4),
  motion("deflection", "Deflection", (row) => row.deflection_peak, "rad", 4),
  motion("rate", "Rate", (row) => row.rate_peak, "rad/s", 3),
  motion("acceleration", "Acceleration", (row) => row.acceleration_peak, "rad/s2", 2),
  {
    key: "limits",
    header: "Limits",
    render: (row) => (row.within_limits ? "within" : "exceeded"),
  },
];

/** Surface motion of a design compared with the actuator limits. */
export function Checks({ design, level, view, onChange }: PartProps) {
  const checks = useQuery(
    designChecksQuery(design.id, level, {
      natural_frequency: view.actuator ?? ACTUATOR,
      position: view.position === undefined ? undefined : view.position / RADIAN,
      rate: view.rate === undefined ? undefined : view.rate / RADIAN,
    }),
  );
  return (
    <Section
      title="Behind the actuator"
      note="Largest of one period, damping ratio 0.7; throttles without actuator, their limit is the full range"
    >
      <Group mb="sm">
        <Limit
          label="Natural frequency [rad/s]"
          value={view.actuator}
          placeholder={String(ACTUATOR)}
          onChange={(actuator) => {
            onChange({ actuator });
          }}
        />
        <Limit
          label="Deflection limit"
          unit="deg"
          value={view.position}
          onChange={(position) => {
            onChange({ position });
          }}
        />
        <Limit
          label="Rate limit"
          unit="deg/s"
          value={view.rate}
          onChange={(rate) => {
            onChange({ rate });
          }}
        />
      </Group>
      <Loaded query={checks} rows={design.specification.inputs.length}>
        {(found) => (
          <>
            <DataTable
              label="Inputs"
              testId="design-checks"
              columns={CHECK_COLUMNS}
              rows={found.inputs}
              rowKey={(row) => row.name}
              isSelected={(row) => !row.within_limits}
            />
            <p className="quiet">
              Largest correlation between two inputs over a period:{" "}
              {found.correlation.toExponential(1)}
            </p>
          </>
        )}
      </Loaded>
    </Section>
  );
}

interface LimitProps {
  label: string;
  unit?: string;
  value: number | undefined;
  placeholder?: string;
  onChange: (value: number | undefined) => void;
}

function Limit({ placeholder = "none", ...field }: LimitProps) {
  return <NumberField {...field} placeholder={placeholder} isPositive w={190} />;
}

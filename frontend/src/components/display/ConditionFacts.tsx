import type { ReactNode } from "react";
import type { Maneuver } from "../../api/types";
import { fixed, percent } from "../../lib/text/format";
import { quantityFact } from "./Quantity";

export function Facts({
  facts,
}: {
  facts: [label: ReactNode, value: ReactNode, unit?: ReactNode][];
}) {
  return (
    <dl className="facts">
      {facts.map(([label, value, unit], index) => (
        <div key={index}>
          <dt>{label}</dt>
          <dd>
            {value} {unit !== undefined && <span className="unit">{unit}</span>}
          </dd>
        </div>
      ))}
    </dl>
  );
}

const isLateral = ({ axis }: Maneuver) => axis === "lateral" || axis === "combined";

/** The flight condition, averaged over the maneuver. */
export function ConditionFacts({ maneuver }: { maneuver: Maneuver }) {
  const { condition } = maneuver;
  const pressure = 0.5 * condition.density_kg_m3 * condition.airspeed_m_s ** 2;
  // Each axis has its own inertias; the others are known or not, and not used.
  const inertias = [
    ["Pitch inertia", condition.pitch_inertia_kg_m2, maneuver.axis !== "lateral"],
    ["Roll inertia", condition.roll_inertia_kg_m2, isLateral(maneuver)],
    ["Yaw inertia", condition.yaw_inertia_kg_m2, isLateral(maneuver)],
  ] as const;
  return (
    <Facts
      facts={[
        quantityFact("Airspeed", condition.airspeed_m_s, "m/s", 2),
        [
          <>
            V/V<sub>f</sub>
          </>,
          fixed(maneuver.airspeed_ratio, 3),
        ],
        quantityFact("Dynamic pressure", pressure, "Pa", 1),
        ["Fuel", percent(condition.fuel_fraction), "%"],
        quantityFact("Mass", condition.mass_kg, "kg", 1),
        ...inertias
          .filter(([, , isUsed]) => isUsed)
          .map(([label, value]) => quantityFact(label, value, "kg*m2", 1)),
        quantityFact("Angle of attack", condition.alpha_rad, "rad", 4),
        quantityFact("Air density", condition.density_kg_m3, "kg/m3", 3),
        ["Length", fixed(maneuver.duration_s, 1), "s"],
        ["Largest input correlation", fixed(maneuver.max_input_correlation, 2)],
      ]}
    />
  );
}

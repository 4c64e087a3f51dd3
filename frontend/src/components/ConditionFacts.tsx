import type { ReactNode } from "react";
import type { Maneuver } from "../api/types";
import { degrees, fixed, percent } from "../lib/format";

export function Facts({ facts }: { facts: [label: ReactNode, value: ReactNode, unit?: string][] }) {
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

/** The flight condition, averaged over the maneuver. */
export function ConditionFacts({ maneuver }: { maneuver: Maneuver }) {
  const { condition } = maneuver;
  const pressure = 0.5 * condition.density_kg_m3 * condition.airspeed_m_s ** 2;
  return (
    <Facts
      facts={[
        ["Airspeed", fixed(condition.airspeed_m_s, 2), "m/s"],
        [
          <>
            V/V<sub>f</sub>
          </>,
          fixed(maneuver.airspeed_ratio, 3),
        ],
        ["Dynamic pressure", fixed(pressure, 1), "Pa"],
        ["Fuel", percent(condition.fuel_fraction), "%"],
        ["Mass", fixed(condition.mass_kg, 1), "kg"],
        ["Pitch inertia", fixed(condition.pitch_inertia_kg_m2, 1), "kg m²"],
        ["Angle of attack", fixed(degrees(condition.alpha_rad), 2), "deg"],
        ["Air density", fixed(condition.density_kg_m3, 3), "kg/m³"],
        ["Length", fixed(maneuver.duration_s, 1), "s"],
        ["Largest input correlation", fixed(maneuver.max_input_correlation, 2)],
      ]}
    />
  );
}

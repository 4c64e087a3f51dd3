import { SegmentedControl } from "@mantine/core";
import { MODEL_AXES, type ModelAxis } from "../../api/types";
import { axisNames } from "../../lib/derivatives";
import { asAxis } from "../new-run/runRequest";

interface Props {
  /** Axis of the maneuver. */
  maneuver: string;
  value: ModelAxis;
  onChange: (axis: ModelAxis) => void;
}

export const AXIS_LABELS: Record<ModelAxis, string> = {
  longitudinal: "Longitudinal",
  lateral: "Lateral-directional",
  "longitudinal-airspeed": "Longitudinal with airspeed",
};

/** The axes of the models of a maneuver: of its symmetry, all if it excites both. */
const axesOf = (maneuver: string): ModelAxis[] =>
  MODEL_AXES.filter(
    (axis) =>
      axis === asAxis(maneuver) ||
      maneuver === "combined" ||
      (maneuver !== "ground" && axisNames(axis).symmetry === axisNames(maneuver).symmetry),
  );

/** Axis of a model, where a maneuver has models of several. */
export function AxisPicker({ maneuver, value, onChange }: Props) {
  const axes = axesOf(maneuver);
  if (axes.length < 2) return null;
  return (
    <SegmentedControl
      aria-label="Axis of the model"
      data-testid="model-axis"
      data={axes.map((axis) => ({ value: axis, label: AXIS_LABELS[axis] }))}
      value={value}
      onChange={(next) => {
        onChange(asAxis(next));
      }}
    />
  );
}

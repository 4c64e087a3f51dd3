import { SegmentedControl } from "@mantine/core";
import type { ModelAxis } from "../api/types";
import { asAxis } from "./runRequest";

interface Props {
  value: ModelAxis;
  onChange: (axis: ModelAxis) => void;
}

/** Axis of a model of a maneuver that excites both. */
export function AxisPicker({ value, onChange }: Props) {
  return (
    <SegmentedControl
      aria-label="Axis of the model"
      data-testid="model-axis"
      data={[
        { value: "longitudinal", label: "Longitudinal" },
        { value: "lateral", label: "Lateral-directional" },
      ]}
      value={value}
      onChange={(next) => {
        onChange(asAxis(next));
      }}
    />
  );
}

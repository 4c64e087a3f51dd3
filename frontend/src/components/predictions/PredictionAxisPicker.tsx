import { Input, SegmentedControl } from "@mantine/core";
import { PREDICTION_AXES, type PredictionAxis } from "../../views";
import { AXIS_LABELS } from "../controls/AxisPicker";

interface Props {
  description?: string;
  value: PredictionAxis;
  onChange: (axis: PredictionAxis) => void;
}

/** Axis of the derivatives of a prediction. */
export function PredictionAxisPicker({ description, value, onChange }: Props) {
  return (
    <Input.Wrapper label="Axis" description={description}>
      <SegmentedControl
        aria-label="Axis of the prediction"
        data-testid="prediction-axis"
        mt={4}
        fullWidth
        data={PREDICTION_AXES.map((axis) => ({ value: axis, label: AXIS_LABELS[axis] }))}
        value={value}
        onChange={(next) => {
          onChange(next === "lateral" ? "lateral" : "longitudinal");
        }}
      />
    </Input.Wrapper>
  );
}

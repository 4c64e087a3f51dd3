import { Switch } from "@mantine/core";

interface OutOfBandSwitchProps {
  value: "residualized" | undefined;
  onChange: (value: "residualized" | undefined) => void;
}

/** Switch between predicted and residualised out-of-band modes. */
export function OutOfBandSwitch({ value, onChange }: OutOfBandSwitchProps) {
  return (
    <Switch
      label="Include out-of-band modes"
      description="In a second fit of each run; otherwise residualised"
      data-testid="include-out-of-band"
      checked={value === undefined}
      onChange={(event) => {
        onChange(event.currentTarget.checked ? undefined : "residualized");
      }}
    />
  );
}

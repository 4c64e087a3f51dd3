import { Switch } from "@mantine/core";

interface OutOfBandSwitchProps {
  others: "residualized" | undefined;
  onChange: (others: "residualized" | undefined) => void;
}

/** Switch between predicted and residualised out-of-band modes. */
export function OutOfBandSwitch({ others, onChange }: OutOfBandSwitchProps) {
  return (
    <Switch
      label="Include out-of-band modes"
      description="In a second fit of each run; otherwise residualised"
      data-testid="include-out-of-band"
      checked={others === undefined}
      onChange={(event) => {
        onChange(event.currentTarget.checked ? undefined : "residualized");
      }}
    />
  );
}

import { Switch } from "@mantine/core";

interface CarrySwitchProps {
  others: "residualized" | undefined;
  onChange: (others: "residualized" | undefined) => void;
}

/** Whether modes that runs left out are carried as predicted. */
export function CarrySwitch({ others, onChange }: CarrySwitchProps) {
  return (
    <Switch
      label="Carry modes left out as predicted"
      description="In a second fit of each run; else its derivatives hold their static response"
      data-testid="carry-others"
      checked={others === undefined}
      onChange={(event) => {
        onChange(event.currentTarget.checked ? undefined : "residualized");
      }}
    />
  );
}

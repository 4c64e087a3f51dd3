import { Select } from "@mantine/core";

interface Props {
  names: readonly string[];
  value: string | undefined;
  onChange: (name: string) => void;
}

/** Which derivative a figure is about. */
export function DerivativeSelect({ names, value, onChange }: Props) {
  return (
    <Select
      aria-label="Derivative"
      searchable
      allowDeselect={false}
      w={180}
      data-testid="derivative"
      data={[...names]}
      value={value ?? null}
      onChange={(name) => {
        if (name !== null) onChange(name);
      }}
    />
  );
}

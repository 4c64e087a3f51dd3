import { Select } from "@mantine/core";
import type { Choice } from "../../api/types";

interface Props {
  label: string;
  choices: readonly Choice[] | undefined;
  value: string | undefined;
  width: number;
  testId: string;
  onChange: (value: string | undefined) => void;
}

/** Filter whose options show the number of matching rows. */
export function FacetSelect({ label, choices, value, width, testId, onChange }: Props) {
  const data = (choices ?? []).map((choice) => ({
    value: choice.value,
    label: `${choice.label} (${choice.count})`,
  }));
  if (value !== undefined && !data.some((one) => one.value === value)) {
    data.push({ value, label: value });
  }
  return (
    <Select
      label={label}
      placeholder="any"
      w={width}
      clearable
      searchable={data.length > 10}
      data-testid={testId}
      comboboxProps={{ width: Math.max(width, 130), position: "bottom-start" }}
      data={data}
      value={value ?? null}
      onChange={(next) => {
        onChange(next ?? undefined);
      }}
    />
  );
}

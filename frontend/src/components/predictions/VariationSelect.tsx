import { Select } from "@mantine/core";
import { VARIATIONS } from "../../views";

type Variation = (typeof VARIATIONS)[number] | undefined;

interface VariationSelectProps {
  value: Variation;
  onChange: (value: Variation) => void;
}

/** Selection of how derivatives vary over the envelope. */
export function VariationSelect({ value, onChange }: VariationSelectProps) {
  return (
    <Select
      label="Derivatives over the envelope"
      description="Linear needs three dynamic pressures, a global model four runs"
      allowDeselect={false}
      data-testid="flutter-variation"
      data={[
        { value: "constant", label: "Constant" },
        { value: "linear", label: "Linear over dynamic pressure" },
        { value: "global-model", label: "Global model" },
      ]}
      value={value ?? "constant"}
      onChange={(selected) => {
        onChange(VARIATIONS.find((one) => one === selected));
      }}
    />
  );
}

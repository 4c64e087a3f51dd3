import { Checkbox, Group } from "@mantine/core";
import { SymbolTooltip } from "../display/SymbolTooltip";
import { METHOD_NAMES, METHODS, type Method } from "../../api/types";

interface Props {
  value: Method[];
  onChange: (methods: Method[]) => void;
}

/** Selection of the methods; one run per method. */
export function MethodPicker({ value, onChange }: Props) {
  return (
    <Group gap="sm" role="group" aria-label="Methods">
      {METHODS.map((method) => (
        <Checkbox
          key={method}
          label={
            <>
              <SymbolTooltip name={method}>
                <b>{method}</b>
              </SymbolTooltip>{" "}
              <span className="quiet">{METHOD_NAMES[method]}</span>
            </>
          }
          mr="md"
          data-testid={`method-${method}`}
          checked={value.includes(method)}
          onChange={(event) => {
            const ticked = event.currentTarget.checked;
            onChange(METHODS.filter((one) => (one === method ? ticked : value.includes(one))));
          }}
        />
      ))}
    </Group>
  );
}

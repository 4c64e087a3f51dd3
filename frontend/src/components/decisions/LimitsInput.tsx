import { Button, Group, Select, Text } from "@mantine/core";
import { typedNumber } from "../../lib/text/format";
import { QUANTITIES, type TypedLimits } from "../../lib/limits";
import { NumberField } from "../controls/NumberField";
import { UnitName } from "../display/Quantity";

interface Props {
  value: TypedLimits;
  onChange: (value: TypedLimits) => void;
}

/** The range of conditions: a row of limits for each quantity that is limited. */
export function LimitsInput({ value, onChange }: Props) {
  const limited = QUANTITIES.filter(({ key }) => value[key] !== undefined);
  const others = QUANTITIES.filter(({ key }) => value[key] === undefined);
  return (
    <div className="stack" role="group" aria-label="Range of conditions">
      <Text size="xs" fw={500}>
        Quantity
      </Text>
      {limited.length === 0 && (
        <Text size="sm" className="quiet">
          All conditions of the campaign
        </Text>
      )}
      {limited.map(({ key, label, unit }) => {
        const [low, high] = value[key] ?? ["", ""];
        return (
          <Group key={key} gap="xs">
            <Text size="sm" w={150}>
              {label}
              {unit !== "" && (
                <>
                  {" "}
                  [<UnitName unit={unit} />]
                </>
              )}
            </Text>
            <NumberField
              aria-label={`${label} from`}
              w={90}
              hideControls
              unit={unit}
              value={typedNumber(low)}
              onChange={(next) => {
                onChange({ ...value, [key]: [write(next), high] });
              }}
            />
            <Text size="sm">to</Text>
            <NumberField
              aria-label={`${label} to`}
              w={90}
              hideControls
              unit={unit}
              value={typedNumber(high)}
              onChange={(next) => {
                onChange({ ...value, [key]: [low, write(next)] });
              }}
            />
            <Button
              variant="subtle"
              size="compact-xs"
              onClick={() => {
                onChange(
                  Object.fromEntries(Object.entries(value).filter(([other]) => other !== key)),
                );
              }}
            >
              Remove
            </Button>
          </Group>
        );
      })}
      {others.length > 0 && (
        <Select
          aria-label="Limit another quantity"
          placeholder="Limit a quantity"
          w={260}
          data={others.map(({ key, label }) => ({ value: key, label }))}
          value={null}
          onChange={(key) => {
            if (key !== null) onChange({ ...value, [key]: ["", ""] });
          }}
        />
      )}
    </div>
  );
}

function write(value: number | undefined): string {
  return value === undefined ? "" : String(value);
}

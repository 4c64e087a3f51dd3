import { Checkbox, Stack, Switch, Table, Text } from "@mantine/core";
import { useState } from "react";
import type { ModalTableDetail } from "../api/types";
import { fixed, hertz } from "../lib/format";
import { atFuel } from "../lib/modes";

interface Props {
  table: ModalTableDetail;
  fuel: number;
  value: number[];
  onChange: (modes: number[]) => void;
}

/** Structural modes at the maneuver's fuel; a longitudinal model takes symmetric ones. */
export function ModeChecklist({ table, fuel, value, onChange }: Props) {
  const [others, setOthers] = useState(false);
  const omega = table.omega ? atFuel(table.fuel, table.omega, fuel) : [];
  const rows = table.numbers
    .map((number, place) => ({
      number,
      name: table.names[place] ?? "",
      symmetric: table.symmetric[place] ?? true,
      omega: omega[place],
    }))
    .filter((mode) => others || mode.symmetric || value.includes(mode.number));
  const hasOthers = table.symmetric.some((symmetric) => !symmetric);
  return (
    <Stack gap="xs">
      <Table verticalSpacing={4} fz="sm" className="numbers" withRowBorders={false}>
        <Table.Tbody>
          {rows.map((mode) => (
            <Table.Tr key={mode.number}>
              <Table.Td w={64}>
                <Checkbox
                  label={mode.number}
                  aria-label={`Mode ${mode.number}`}
                  data-testid={`mode-${mode.number}`}
                  checked={value.includes(mode.number)}
                  onChange={(event) => {
                    const ticked = event.currentTarget.checked;
                    onChange(
                      table.numbers.filter((number) =>
                        number === mode.number ? ticked : value.includes(number),
                      ),
                    );
                  }}
                />
              </Table.Td>
              <Table.Td>{mode.name}</Table.Td>
              <Table.Td ta="right" w={90}>
                {mode.omega !== undefined && (
                  <>
                    {fixed(hertz(mode.omega), 2)} <span className="unit">Hz</span>
                  </>
                )}
              </Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
      {value.length === 0 && (
        <Text size="xs" className="quiet">
          Without a mode the model is the rigid-body short period.
        </Text>
      )}
      {hasOthers && (
        <Switch
          label="Show antisymmetric modes"
          checked={others}
          onChange={(event) => {
            setOthers(event.currentTarget.checked);
          }}
        />
      )}
    </Stack>
  );
}

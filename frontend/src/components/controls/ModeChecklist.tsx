import { Checkbox, Stack, Switch, Table, Text } from "@mantine/core";
import { useState } from "react";
import type { ModalTableDetail } from "../../api/types";
import { axisNames } from "../../lib/derivatives";
import { hertz } from "../../lib/text/format";
import { atFuel, mayHaveSymmetry } from "../../lib/modes";
import { Quantity } from "../display/Quantity";

interface Props {
  table: ModalTableDetail;
  axis: string;
  fuel: number;
  value: number[];
  onChange: (modes: number[]) => void;
}

/** Structural modes at the maneuver's fuel; a model takes those of the symmetry of its axis. */
export function ModeChecklist({ table, axis, fuel, value, onChange }: Props) {
  const [others, setOthers] = useState(false);
  const isSymmetric = axisNames(axis).symmetry === "symmetric";
  const omega = table.omega ? atFuel(table.fuel, table.omega, fuel) : [];
  const rows = table.numbers
    .map((number, index) => ({
      number,
      name: table.names[index] ?? "",
      own: mayHaveSymmetry(table.symmetric[index], isSymmetric),
      omega: omega[index],
    }))
    .filter((mode) => others || mode.own || value.includes(mode.number));
  const hasOthers = table.symmetric.some((own) => !mayHaveSymmetry(own, isSymmetric));
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
              <Table.Td ta="right" style={{ whiteSpace: "nowrap" }}>
                {mode.omega !== undefined && (
                  <Quantity value={hertz(mode.omega)} unit="Hz" decimals={2} named />
                )}
              </Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
      {value.length === 0 && (
        <Text size="xs" className="quiet">
          Without a mode the model is that of a rigid aircraft.
        </Text>
      )}
      {hasOthers && (
        <Switch
          label={`Show ${isSymmetric ? "antisymmetric" : "symmetric"} modes`}
          checked={others}
          onChange={(event) => {
            setOthers(event.currentTarget.checked);
          }}
        />
      )}
    </Stack>
  );
}

import { Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import type { ReactNode } from "react";
import { modalTableQuery } from "../../api/queries";
import type { ModalTable, ModalTableDetail } from "../../api/types";
import { hertz, percent } from "../../lib/text/format";
import { someFuels, symmetryLetter } from "../../lib/modes";
import { DataTable, type Column } from "../controls/DataTable";
import { Loaded } from "../display/Loaded";
import { Quantity, UnitName } from "../display/Quantity";
import { Section } from "../display/Section";

interface Row {
  number: number;
  name: string;
  symmetric: boolean | null;
  index: number;
}

/** Frequencies (and damping, where known) of a modal table, mode by mode over fuel. */
export function ModalTableView({ table }: { table: ModalTable }) {
  const detail = useQuery(modalTableQuery(table.id));
  return (
    <Section title={table.name} note={[table.kind, table.origin].filter(Boolean).join(", ")}>
      <Loaded query={detail} rows={6}>
        {(modal) => (
          <>
            <DataTable
              label={table.name}
              columns={columnsOf(modal)}
              rows={modal.numbers.map((number, index) => ({
                number,
                name: modal.names[index] ?? "",
                symmetric: modal.symmetric[index] ?? null,
                index,
              }))}
              rowKey={(row) => row.number}
            />
            {modal.omega !== null && (
              <Text size="xs" className="quiet numbers" p="xs">
                Standard deviation of the frequencies that runs assume:{" "}
                {percent(modal.frequency_std, 1)} %
              </Text>
            )}
          </>
        )}
      </Loaded>
    </Section>
  );
}

function columnsOf(modal: ModalTableDetail): Column<Row>[] {
  const over = (
    kind: string,
    unit: ReactNode,
    values: number[][] | null,
    show: (value: number | undefined) => ReactNode,
  ): Column<Row>[] =>
    (values === null ? [] : someFuels(modal.fuel)).map((index) => ({
      key: `${kind}${index}`,
      header: `${kind} at ${percent(modal.fuel[index])} %`,
      unit,
      numeric: true,
      render: ({ index: mode }) => show(values?.[index]?.[mode]),
    }));
  return [
    { key: "number", header: "Mode", numeric: true, render: (row) => row.number },
    { key: "name", header: "Shape", render: (row) => row.name },
    { key: "symmetric", header: "Symmetry", render: (row) => symmetryLetter(row.symmetric) },
    ...over("f", <UnitName unit="Hz" />, modal.omega, (value) => (
      <Quantity value={value === undefined ? undefined : hertz(value)} unit="Hz" decimals={2} />
    )),
    ...over("ζ", "%", modal.zeta, (value) => percent(value, 2)),
  ];
}

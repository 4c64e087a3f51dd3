import { Text } from "@mantine/core";
import type { Difference } from "../../lib/structure";
import { parseDerivative } from "../../lib/derivatives";
import { DataTable, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";

interface Props {
  found: Difference[];
  before: string;
  after: string;
}

/** What differs between two structures, term by term. */
export function StructureDifference({ found, before, after }: Props) {
  if (found.length === 0) {
    return (
      <Text size="sm" className="quiet" data-testid="structure-difference">
        {before} and {after} are identical.
      </Text>
    );
  }
  const columns: Column<Difference>[] = [
    {
      key: "what",
      header: "Item",
      render: (one) =>
        parseDerivative(one.what) === null ? one.what : <DerivativeName name={one.what} />,
    },
    { key: "before", header: before, render: (one) => one.before },
    { key: "after", header: after, render: (one) => one.after },
  ];
  return (
    <DataTable
      label="Difference"
      testId="structure-difference"
      columns={columns}
      rows={found}
      rowKey={(one) => one.what}
      maxHeight={360}
    />
  );
}

import type { LiveEstimate } from "../../api/types";
import { percent, withError } from "../../lib/text/format";
import { adviseDuration } from "../../lib/live/information";
import { DataTable, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { Empty } from "../display/Empty";
import { Section } from "../display/Section";

interface Row {
  name: string;
  value: number;
  std: number | null;
  expected: number | null;
}

/** Part of the expected Fisher information: that of the record so far over that of the whole maneuver. */
const gathered = ({ std, expected }: Row): number | null =>
  std === null || expected === null || std === 0 ? null : (expected / std) ** 2;

const COLUMNS: Column<Row>[] = [
  { key: "name", header: "Derivative", render: (row) => <DerivativeName name={row.name} /> },
  {
    key: "value",
    header: "Estimate ± σ",
    numeric: true,
    render: (row) => {
      const { value, error } = withError(row.value, row.std);
      return `${value} ± ${error}`;
    },
  },
  {
    key: "expected",
    header: "Expected σ",
    numeric: true,
    onlyIf: (row) => row.expected !== null,
    render: (row) => withError(row.value, row.expected).error,
  },
  {
    key: "information",
    header: "Information of expected",
    unit: "%",
    numeric: true,
    onlyIf: (row) => row.expected !== null,
    render: (row) => {
      const part = gathered(row);
      return (
        <>
          {percent(part)}{" "}
          <span className="fit-bar" aria-hidden="true">
            <span style={{ width: `${100 * Math.min(1, part ?? 0)}%` }} />
          </span>
        </>
      );
    },
  },
];

interface Props {
  estimate: LiveEstimate | null;
  /** Standard errors expected for the whole maneuver: those of the run with the same settings. */
  expected: Readonly<Record<string, number | null>>;
}

/** Derivatives so far, and how much of the expected information has been recorded. */
export function LiveDerivatives({ estimate, expected }: Props) {
  const rows: Row[] = (estimate?.names ?? []).map((name, index) => ({
    name,
    value: estimate?.values[index] ?? NaN,
    std: estimate?.std_errors[index] ?? null,
    expected: expected[name] ?? null,
  }));
  const compared = rows.map(gathered).filter((part) => part !== null);
  return (
    <Section title="Derivatives" note={adviseDuration(compared)}>
      {rows.length === 0 ? (
        <Empty title="No estimate yet" />
      ) : (
        <DataTable
          label="Derivatives"
          testId="live-derivatives"
          columns={COLUMNS}
          rows={rows}
          rowKey={(row) => row.name}
          maxHeight={420}
        />
      )}
    </Section>
  );
}

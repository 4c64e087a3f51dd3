import { UnstyledButton } from "@mantine/core";
import { fixed } from "../../lib/text/format";
import { DataTable, numeric, type Column } from "../controls/DataTable";

interface Quality {
  output: string;
  theil: number | null;
  whiteness: number | null;
}

interface Props {
  /** R² by output. */
  values: Record<string, number>;
  /** Further figures of the fit of an output. */
  quality?: readonly Quality[];
  selected?: string;
  onSelect?: (name: string) => void;
  label?: string;
}

/** R² of each output as number and bar, Theil's coefficient and whiteness; an output can be picked to see its fit. */
export function FitTable({
  values,
  quality = [],
  selected,
  onSelect,
  label = "Fit by output",
}: Props) {
  const columns: Column<{ name: string; value: number; quality?: Quality }>[] = [
    {
      key: "output",
      header: "Output",
      render: ({ name }) =>
        onSelect === undefined ? (
          name
        ) : (
          <UnstyledButton
            fz="sm"
            className="link"
            aria-pressed={name === selected}
            onClick={() => {
              onSelect(name);
            }}
          >
            {name}
          </UnstyledButton>
        ),
    },
    numeric("r2", "R²", (one) => fixed(one.value, 3)),
    {
      key: "bar",
      header: "",
      render: ({ value }) => (
        <span className="fit-bar" aria-hidden="true">
          <span style={{ width: `${100 * Math.max(0, Math.min(1, value))}%` }} />
        </span>
      ),
    },
    numeric(
      "theil",
      <span title="Theil's inequality coefficient: 0 is a perfect fit, 1 none">Theil</span>,
      (one) => fixed(one.quality?.theil, 3),
    ),
    numeric(
      "white",
      <span title="Probability of as much correlation between frequencies for white residuals">
        White
      </span>,
      (one) => fixed(one.quality?.whiteness, 2),
    ),
  ];
  return (
    <DataTable
      label={label}
      testId="fit-table"
      columns={columns}
      rows={Object.entries(values).map(([name, value]) => ({
        name,
        value,
        quality: quality.find((one) => one.output === name),
      }))}
      rowKey={(one) => one.name}
      isSelected={(one) => one.name === selected}
    />
  );
}

import { UnstyledButton } from "@mantine/core";
import { fixed } from "../lib/format";

interface Props {
  /** R² by output. */
  values: Record<string, number>;
  selected?: string;
  onSelect?: (name: string) => void;
  label?: string;
}

/** R² of each output as number and bar; an output can be picked to see its fit. */
export function FitTable({ values, selected, onSelect, label = "Fit by output" }: Props) {
  return (
    <table className="data-table" aria-label={label} data-testid="fit-table">
      <thead>
        <tr>
          <th scope="col">Output</th>
          <th scope="col" className="end">
            R²
          </th>
          <th scope="col" aria-hidden="true" />
        </tr>
      </thead>
      <tbody>
        {Object.entries(values).map(([name, value]) => (
          <tr key={name} data-selected={name === selected}>
            <td>
              {onSelect === undefined ? (
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
              )}
            </td>
            <td className="end">{fixed(value, 3)}</td>
            <td>
              <span className="fit-bar" aria-hidden="true">
                <span style={{ width: `${100 * Math.max(0, Math.min(1, value))}%` }} />
              </span>
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

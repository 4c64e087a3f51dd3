import { UnstyledButton } from "@mantine/core";
import { fixed } from "../lib/format";

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
  const of = (name: string) => quality.find((one) => one.output === name);
  return (
    <table className="data-table" aria-label={label} data-testid="fit-table">
      <thead>
        <tr>
          <th scope="col">Output</th>
          <th scope="col" className="end">
            R²
          </th>
          <th scope="col" aria-hidden="true" />
          <th scope="col" className="end">
            <span title="Theil's inequality coefficient: 0 is a perfect fit, 1 none">Theil</span>
          </th>
          <th scope="col" className="end">
            <span title="Probability of as much correlation between frequencies for white residuals">
              White
            </span>
          </th>
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
            <td className="end">{fixed(of(name)?.theil, 3)}</td>
            <td className="end">{fixed(of(name)?.whiteness, 2)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

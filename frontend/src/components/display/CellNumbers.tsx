import type { Parameter } from "../../api/types";
import { relativeError, significant, withError } from "../../lib/text/format";

/** Value, σ, σ in percent and F of one estimate, small enough for a cell of the grid. */
export function CellNumbers({ parameter }: { parameter: Parameter | undefined }) {
  if (parameter === undefined) return null;
  const { value, error } = withError(parameter.value, parameter.std_error);
  const ratio = partialF(parameter);
  return (
    <>
      <span className="sub">{value}</span>
      <span className="sub quiet">± {error}</span>
      <span className="sub quiet">
        {significant(relativeError(parameter.value, parameter.std_error), 2)} %
      </span>
      <span className={ratio !== null && ratio < 4 ? "sub weak" : "sub quiet"}>
        F {significant(ratio, 3)}
      </span>
    </>
  );
}

/** Partial F ratio of one parameter: the square of value over standard error. */
function partialF(parameter: Parameter): number | null {
  if (parameter.std_error === null || parameter.std_error === 0) return null;
  return (parameter.value / parameter.std_error) ** 2;
}

import { SymbolTooltip } from "./SymbolTooltip";
import { derivativeIndex, parseDerivative, variableParts } from "../../lib/derivatives";

/** A variable in the field's notation. */
export function VariableName({ variable }: { variable: string }) {
  const { symbol, index } = variableParts(variable);
  return (
    <span>
      {symbol}
      {index !== "" && <sub>{index}</sub>}
    </span>
  );
}

export function CoefficientName({ coefficient }: { coefficient: string }) {
  return (
    <span>
      C<sub>{coefficient.slice(1)}</sub>
    </span>
  );
}

/** `Cm_alpha` as it is written on paper; other parameters (delays) by their own name. */
export function DerivativeName({ name }: { name: string }) {
  const parsed = parseDerivative(name);
  if (parsed === null) return <span>{name}</span>;
  return (
    <SymbolTooltip name={name}>
      <span role="img" aria-label={name} style={{ whiteSpace: "nowrap" }}>
        C<sub>{derivativeIndex(parsed)}</sub>
      </span>
    </SymbolTooltip>
  );
}

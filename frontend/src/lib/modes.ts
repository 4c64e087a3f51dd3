/** Places of at most five fuels, spread evenly, the ends among them. */
export function someFuels(fuels: readonly number[]): number[] {
  const count = Math.min(5, fuels.length);
  return Array.from({ length: count }, (_, step) =>
    count === 1 ? 0 : Math.round((step * (fuels.length - 1)) / (count - 1)),
  );
}

/** Value of each mode at a fuel fraction, linear between the table's fuels. */
export function atFuel(
  fuels: readonly number[],
  table: readonly (readonly number[])[],
  fuel: number,
): number[] {
  const first = table[0] ?? [];
  const last = table.at(-1) ?? first;
  const above = fuels.findIndex((one) => one >= fuel);
  if (above === 0) return [...first];
  if (above === -1) return [...last];
  const low = fuels[above - 1] ?? 0;
  const high = fuels[above] ?? 1;
  const share = (fuel - low) / (high - low);
  const below = table[above - 1] ?? first;
  return (table[above] ?? last).map(
    (value, mode) => (1 - share) * (below[mode] ?? value) + share * value,
  );
}

/** Whether a mode may be one of symmetric (or antisymmetric) motion: of both if that is unknown. */
export const mayHaveSymmetry = (known: boolean | null | undefined, symmetric: boolean): boolean =>
  (known ?? symmetric) === symmetric;

export const symmetryLetter = (known: boolean | null): string =>
  known === null ? "unknown" : known ? "S" : "A";

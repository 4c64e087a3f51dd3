/** Tint behind text of the page's own color, for contrast in both themes. */
export const tint = (color: string) =>
  `light-dark(var(--mantine-color-${color}-1), color-mix(in srgb, var(--mantine-color-${color}-9) 40%, #242424))`;

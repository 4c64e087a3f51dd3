/** The window over frequency that figures of a page share, as its address keeps it. */

export interface Band {
  low?: number;
  high?: number;
}

export function windowOf({ low, high }: Band): [number, number] | undefined {
  return low !== undefined && high !== undefined && high > low ? [low, high] : undefined;
}

/** Frequencies below zero are not in any band. */
export const bandOf = (window: [number, number] | null): Band => ({
  low: window === null ? undefined : Math.max(0, window[0]),
  high: window?.[1],
});

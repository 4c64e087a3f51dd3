/** Window over frequency that figures of a page share, as stored in its address. */

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

/** The window over time that figures of a page share. */
export interface Span {
  from?: number;
  to?: number;
}

const spanWindow = ({ from, to }: Span): [number, number] | undefined =>
  from !== undefined && to !== undefined && to > from ? [from, to] : undefined;

const spanOf = (window: [number, number] | null): Span => ({
  from: window?.[0],
  to: window?.[1],
});

/** What a figure over frequency needs to share zoom and cursor with the others of its page. */
export const overFrequency = (view: Band, onChange: (change: Band) => void) => ({
  link: "frequency",
  window: windowOf(view),
  onWindow: (window: [number, number] | null) => {
    onChange(bandOf(window));
  },
});

/** The same over time. */
export const overTime = (view: Span, onChange: (change: Span) => void) => ({
  link: "time",
  window: spanWindow(view),
  onWindow: (window: [number, number] | null) => {
    onChange(spanOf(window));
  },
});

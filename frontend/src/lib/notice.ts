/** One sentence at the foot of the page about what was just done, with the way back. */
import { useSyncExternalStore } from "react";

interface Notice {
  text: string;
  undo?: () => void;
}

const STAYS_MS = 20_000;

let shown: Notice | null = null;
let timer: ReturnType<typeof setTimeout> | undefined;
const listeners = new Set<() => void>();

export function notify(notice: Notice | null): void {
  shown = notice;
  clearTimeout(timer);
  if (notice !== null) {
    timer = setTimeout(() => {
      notify(null);
    }, STAYS_MS);
  }
  for (const listener of listeners) listener();
}

export function useNotice(): Notice | null {
  return useSyncExternalStore(
    (listener) => {
      listeners.add(listener);
      return () => listeners.delete(listener);
    },
    () => shown,
  );
}

/** Whether the guided tour is offered, shown, or was skipped or finished in this browser. */
import { useSyncExternalStore } from "react";

export type TourState = "offered" | "shown" | "ended";

const KEY = "flexsid.tour";
const listeners = new Set<() => void>();

function read(): TourState {
  const stored = localStorage.getItem(KEY);
  return stored === "shown" || stored === "ended" ? stored : "offered";
}

export function setTour(state: TourState): void {
  localStorage.setItem(KEY, state);
  for (const listener of listeners) listener();
}

export function useTour(): TourState {
  return useSyncExternalStore((listener) => {
    listeners.add(listener);
    return () => listeners.delete(listener);
  }, read);
}

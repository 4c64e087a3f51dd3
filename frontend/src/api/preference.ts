/** Preferences of a user in this browser, the same in all of its tabs. */
import { useMemo, useSyncExternalStore } from "react";

const CHANGED = "flexsid-preference";

function read(text: string): Record<string, unknown> {
  try {
    const parsed: unknown = JSON.parse(text);
    return typeof parsed === "object" && parsed !== null ? { ...parsed } : {};
  } catch {
    return {}; // of an earlier release, or by hand
  }
}

export function storePreference(key: string, value: object): void {
  localStorage.setItem(key, JSON.stringify(value));
  window.dispatchEvent(new Event(CHANGED));
}

function subscribe(changed: () => void) {
  window.addEventListener(CHANGED, changed);
  window.addEventListener("storage", changed);
  return () => {
    window.removeEventListener(CHANGED, changed);
    window.removeEventListener("storage", changed);
  };
}

/** What is stored under a key; empty without anything. */
export function usePreference(key: string): Record<string, unknown> {
  const text = useSyncExternalStore(subscribe, () => localStorage.getItem(key) ?? "");
  return useMemo(() => read(text), [text]);
}

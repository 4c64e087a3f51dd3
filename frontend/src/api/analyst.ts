/** The name of the local analyst: set here, sent with every request, verified by nobody. */
import { useSyncExternalStore } from "react";

const KEY = "flexsid.analyst";
const HEADER = "X-Flexsid-Analyst";
const CHANGED = "flexsid-analyst";

export function analystName(): string {
  return localStorage.getItem(KEY) ?? "";
}

export function setAnalystName(name: string): void {
  const plain = name.trim().replace(/\s+/g, " ");
  if (plain === "") localStorage.removeItem(KEY);
  else localStorage.setItem(KEY, plain);
  window.dispatchEvent(new Event(CHANGED));
}

/** The name, also when another tab changes it. */
export function useAnalyst(): string {
  return useSyncExternalStore((changed) => {
    window.addEventListener(CHANGED, changed);
    window.addEventListener("storage", changed);
    return () => {
      window.removeEventListener(CHANGED, changed);
      window.removeEventListener("storage", changed);
    };
  }, analystName);
}

/** Header of what is kept under the name; headers hold no letters beyond ASCII. */
export const named = () => ({ [HEADER]: encodeURIComponent(analystName()) });

export const sameName = (one: string, other: string): boolean =>
  one.localeCompare(other, undefined, { sensitivity: "accent" }) === 0;

/** Name of the local analyst, sent with every request, unverified. */
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

/** Header with the name of the analyst; headers are limited to ASCII. */
export const named = () => ({ [HEADER]: encodeURIComponent(analystName()) });

export const sameName = (one: string, other: string): boolean =>
  one.localeCompare(other, undefined, { sensitivity: "accent" }) === 0;

/** Name of the analyst: of the account, else as set in this browser, unverified. */
import { useSyncExternalStore } from "react";

const KEY = "flexsid.analyst";
const HEADER = "X-Flexsid-Analyst";
const CHANGED = "flexsid-analyst";

const CAMPAIGN_KEY = "flexsid.campaign";
const CAMPAIGN_HEADER = "X-Flexsid-Campaign";

let account: string | null = null;

export function analystName(): string {
  return account ?? localStorage.getItem(KEY) ?? "";
}

/** Sets the name of the account that is logged in; null without accounts. */
export function setAccountName(name: string | null): void {
  account = name;
  window.dispatchEvent(new Event(CHANGED));
}

/** Aircraft in whose campaign records without an aircraft are stored. */
const campaign = (): string => localStorage.getItem(CAMPAIGN_KEY) ?? "";

export function setCampaign(id: string): void {
  localStorage.setItem(CAMPAIGN_KEY, id);
  window.dispatchEvent(new Event(CHANGED));
}

export const useCampaign = (): string => useChanging(campaign);

export function setAnalystName(name: string): void {
  const plain = name.trim().replace(/\s+/g, " ");
  if (plain === "") localStorage.removeItem(KEY);
  else localStorage.setItem(KEY, plain);
  window.dispatchEvent(new Event(CHANGED));
}

/** The name, also when another tab changes it. */
export const useAnalyst = (): string => useChanging(analystName);

const signature = (): string =>
  account === null ? `As ${analystName()}, unverified` : `As ${account}`;

/** Under what name a form is sent. */
export const useSignature = (): string => useChanging(signature);

function useChanging(read: () => string): string {
  return useSyncExternalStore((changed) => {
    window.addEventListener(CHANGED, changed);
    window.addEventListener("storage", changed);
    return () => {
      window.removeEventListener(CHANGED, changed);
      window.removeEventListener("storage", changed);
    };
  }, read);
}

/** Headers with the name of the analyst and the campaign; headers are limited to ASCII. */
export const named = () => ({
  [HEADER]: encodeURIComponent(analystName()),
  ...(account !== null && campaign() !== "" && { [CAMPAIGN_HEADER]: campaign() }),
});

export const sameName = (one: string, other: string): boolean =>
  one.localeCompare(other, undefined, { sensitivity: "accent" }) === 0;

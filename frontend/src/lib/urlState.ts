/**
 * The view lives in the address: plain `key=value` pairs, lists joined by commas,
 * so that an address can be read, written by hand and sent to a colleague.
 */
export type Search = Record<string, unknown>;

export function parseSearch(text: string): Record<string, string> {
  return Object.fromEntries(new URLSearchParams(text));
}

export function stringifySearch(search: Search): string {
  const pairs = Object.entries(search).flatMap(([key, value]) => {
    const text = written(value);
    return text === "" ? [] : [`${key}=${encodeURIComponent(text).replaceAll("%2C", ",")}`];
  });
  return pairs.length > 0 ? `?${pairs.join("&")}` : "";
}

function written(value: unknown): string {
  if (Array.isArray(value)) return value.map(written).join(",");
  if (typeof value === "string") return value;
  return typeof value === "number" || value === true ? String(value) : "";
}

// Readers: what an address holds is text written by anyone; what cannot be read is absent.

export function text(value: unknown): string | undefined {
  if (typeof value === "number") return String(value);
  return typeof value === "string" && value !== "" ? value : undefined;
}

export function number(value: unknown): number | undefined {
  if (typeof value === "number") return Number.isFinite(value) ? value : undefined;
  if (typeof value !== "string" || value.trim() === "") return undefined;
  const parsed = Number(value);
  return Number.isFinite(parsed) ? parsed : undefined;
}

export function integer(value: unknown): number | undefined {
  const parsed = number(value);
  return parsed !== undefined && Number.isSafeInteger(parsed) ? parsed : undefined;
}

export function words(value: unknown): string[] | undefined {
  const items = Array.isArray(value) ? value.map(String) : text(value)?.split(",");
  const texts = items?.map((item) => item.trim()).filter((item) => item !== "");
  return texts !== undefined && texts.length > 0 ? [...new Set(texts)] : undefined;
}

export function integers(value: unknown): number[] | undefined {
  const numbers = words(value)?.flatMap((item) => integer(item) ?? []);
  return numbers !== undefined && numbers.length > 0 ? numbers : undefined;
}

export function oneOf<T extends string>(value: unknown, choices: readonly T[]): T | undefined {
  return choices.find((choice) => choice === value);
}

export function flag(value: unknown): true | undefined {
  return value === true || value === "true" ? true : undefined;
}

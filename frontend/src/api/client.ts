/** HTTP client of the API. */
import createClient from "openapi-fetch";
import { analystName, named } from "./analyst";
import { problemFrom, unreachable } from "./problem";
import type { paths } from "./schema.gen";
import type { Full } from "./types";

/** Event: a request was refused because nobody is logged in. */
export const LOGGED_OUT = "flexsid-logged-out";

async function send(request: Request): Promise<Response> {
  if (analystName() !== "") {
    for (const [header, value] of Object.entries(named())) request.headers.set(header, value);
  }
  try {
    const response = await fetch(request);
    if (response.status === 401) window.dispatchEvent(new Event(LOGGED_OUT));
    return response;
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    throw unreachable();
  }
}

export const api = createClient<paths>({ baseUrl: window.location.origin, fetch: send });

interface FetchResult<T> {
  data?: T;
  error?: unknown;
  response: Response;
}

/** Body of a successful response; any other is thrown as an ApiProblem. */
export async function body<T>(result: Promise<FetchResult<T>>): Promise<Full<T>> {
  const { data, error, response } = await result;
  if (!response.ok) throw problemFrom(error, response.status);
  return data as Full<T>;
}

/** Items of a response that is a list. */
export async function items<T>(result: Promise<FetchResult<{ items: T[] }>>): Promise<Full<T>[]> {
  return (await body(result)).items;
}

export type QueryValue =
  string | number | boolean | null | undefined | readonly (string | number)[];

/** Address under /api/v1; lists are joined by commas, undefined values are omitted. */
export function address(path: string, query: Record<string, QueryValue> = {}): string {
  const pairs = Object.entries(query).flatMap(([key, value]) => {
    if (value === null || value === undefined || value === "") return [];
    const text = Array.isArray(value) ? value.join(",") : String(value);
    return text === "" ? [] : [`${key}=${encodeURIComponent(text).replaceAll("%2C", ",")}`];
  });
  return `/api/v1/${path}${pairs.length > 0 ? `?${pairs.join("&")}` : ""}`;
}

/** Responses whose content OpenAPI does not describe: figure specs and uploads. */
export async function json(path: string, init: RequestInit = {}): Promise<unknown> {
  const response = await send(new Request(new URL(path, window.location.origin), init));
  const content: unknown = await response.json().catch(() => null);
  if (!response.ok) throw problemFrom(content, response.status);
  return content;
}

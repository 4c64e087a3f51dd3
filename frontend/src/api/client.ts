/** The one place that talks to the server. */
import createClient from "openapi-fetch";
import { analystName, named } from "./analyst";
import { problemFrom, unreachable } from "./problem";
import type { paths } from "./schema.gen";
import type { Full } from "./types";

async function send(request: Request): Promise<Response> {
  if (analystName() !== "") {
    for (const [header, name] of Object.entries(named())) request.headers.set(header, name);
  }
  try {
    return await fetch(request);
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    throw unreachable();
  }
}

export const api = createClient<paths>({ baseUrl: window.location.origin, fetch: send });

interface Answer<T> {
  data?: T;
  error?: unknown;
  response: Response;
}

/** The body of a good answer; a bad one is thrown as an ApiProblem. */
export async function body<T>(answer: Promise<Answer<T>>): Promise<Full<T>> {
  const { data, error, response } = await answer;
  if (!response.ok) throw problemFrom(error, response.status);
  return data as Full<T>;
}

/** The items of an answer that is a list. */
export async function items<T>(answer: Promise<Answer<{ items: T[] }>>): Promise<Full<T>[]> {
  return (await body(answer)).items;
}

export type QueryValue =
  string | number | boolean | null | undefined | readonly (string | number)[];

/** Address under /api/v1; lists are joined by commas, what is absent is left out. */
export function address(path: string, query: Record<string, QueryValue> = {}): string {
  const pairs = Object.entries(query).flatMap(([key, value]) => {
    if (value === null || value === undefined || value === "") return [];
    const text = Array.isArray(value) ? value.join(",") : String(value);
    return text === "" ? [] : [`${key}=${encodeURIComponent(text).replaceAll("%2C", ",")}`];
  });
  return `/api/v1/${path}${pairs.length > 0 ? `?${pairs.join("&")}` : ""}`;
}

/** For answers whose content OpenAPI does not describe: figure specs and uploads. */
export async function json(path: string, init: RequestInit = {}): Promise<unknown> {
  const response = await send(new Request(new URL(path, window.location.origin), init));
  const content: unknown = await response.json().catch(() => null);
  if (!response.ok) throw problemFrom(content, response.status);
  return content;
}

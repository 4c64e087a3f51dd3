/** Stored results of analyses: the three requests of each are made from its address. */
import type { Readable } from "openapi-typescript-helpers";
import { api, body } from "./client";
import type { paths } from "./schema.gen";
import type { Full, Job } from "./types";
import type { StoredResultOptions } from "./useStoredResult";

/** Addresses below which a result can be requested. */
type AnalysisPath = keyof paths extends infer P
  ? P extends `${infer A}/results`
    ? A
    : never
  : never;

type Operation<P extends AnalysisPath> = paths[`${P}/results` & keyof paths] extends {
  post: infer O;
}
  ? O
  : never;

/** Ids in the path, and the request in the query. */
type Parameters<P extends AnalysisPath> =
  Operation<P> extends { parameters: infer Given }
    ? Pick<Given, Extract<"path" | "query", keyof Given>>
    : never;

/** The request of an analysis, as in the address. */
export type AnalysisQuery<P extends AnalysisPath> =
  Operation<P> extends { parameters: { query?: infer Query } } ? NonNullable<Query> : never;

type Answer<P extends AnalysisPath> = paths[P & keyof paths] extends {
  get: { responses: { 200: { content: { "application/json": infer T } } } };
}
  ? Full<Readable<T>>
  : never;

type Call = (
  path: string,
  options: object,
) => Promise<{ data?: unknown; error?: unknown; response: Response }>;

/**
 * The stored result of a request; an equal request is the same job.
 *
 * It is requested where `enabled`. `read` returns it where the address has none of its own.
 */
export function storedResult<P extends AnalysisPath, T = Answer<P>>(
  path: P,
  params: Parameters<P>,
  enabled = true,
  read?: (signal: AbortSignal) => Promise<T>,
): StoredResultOptions<T> {
  // The compiler checks path and parameters above; it cannot put them together again.
  const get = api.GET as Call;
  const post = api.POST as Call;
  const results = `${path}/results`;
  return {
    key: [path, params],
    enabled,
    read: read ?? ((signal) => body(get(path, { params, signal })) as Promise<T>),
    find: (signal) => body(get(results, { params, signal })) as Promise<{ job: Job | null }>,
    submit: () => body(post(results, { params })) as Promise<Job>,
  };
}

/**
 * Results that the server computes as jobs and stores: read, or request once and wait.
 *
 * The first complete request is sent at once, changes of it only by `compute`.
 */
import {
  useQuery,
  useQueryClient,
  type QueryKey,
  type UseQueryResult,
} from "@tanstack/react-query";
import { useState } from "react";
import type { Job } from "./types";

export interface StoredResultOptions<T> {
  key: QueryKey;
  enabled: boolean;
  /** Reads the stored result. */
  read: (signal: AbortSignal) => Promise<T>;
  /** Finds the job of an equal request. */
  find: (signal: AbortSignal) => Promise<{ job: Job | null }>;
  /** Requests the result. */
  submit: () => Promise<Job>;
}

interface StoredResult<T> {
  result: UseQueryResult<T>;
  /** The job to wait for, or that failed or was cancelled; undefined once the result is stored. */
  jobId: number | undefined;
  /** Why the result cannot be requested. */
  error: Error | null;
  /** Reads the result after its job has succeeded. */
  onEnd: (job: Job) => void;
  /** Requests the result after a change; undefined if it is requested or cannot be. */
  compute: (() => void) | undefined;
}

const STALE_MS = 60_000;

export function useStoredResult<T>(options: StoredResultOptions<T>): StoredResult<T> {
  const { key, read, find, submit } = options;
  const cache = useQueryClient();
  const request = JSON.stringify(key);
  const [requested, setRequested] = useState<string>();
  if (requested === undefined && options.enabled) setRequested(request);
  const enabled = options.enabled && requested === request;
  const jobKey = ["result job", ...key];
  const job = useQuery({
    queryKey: jobKey,
    queryFn: async ({ signal }) => (await find(signal)).job ?? (await submit()),
    enabled,
    retry: false,
    staleTime: STALE_MS,
  });
  const isStored = job.data?.state === "succeeded";
  const result = useQuery({
    queryKey: [...key, job.data?.id],
    queryFn: ({ signal }) => read(signal),
    enabled: enabled && isStored,
    retry: false,
    staleTime: STALE_MS,
  });
  return {
    result,
    jobId: isStored ? undefined : job.data?.id,
    // A stored result that cannot be read again for the moment is still shown.
    error: job.data === undefined ? job.error : null,
    compute:
      options.enabled && requested !== undefined && requested !== request
        ? () => {
            setRequested(request);
          }
        : undefined,
    onEnd: (ended) => {
      // The job itself shows a failure; reading the result would only repeat it.
      if (ended.state !== "succeeded") return;
      cache.setQueryData(jobKey, ended);
      void cache.invalidateQueries({ queryKey: ["figure"] });
    },
  };
}

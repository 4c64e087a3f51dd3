/** What the server works on: jobs and batches. */
import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";
import type { RunState } from "../types";

export const jobQuery = (id: number) =>
  queryOptions({
    queryKey: ["job", id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/jobs/{job_id}", { params: { path: { job_id: id } }, signal })),
  });

export const jobLogQuery = (id: number) =>
  queryOptions({
    queryKey: ["job", id, "log"],
    queryFn: ({ signal }) =>
      items(api.GET("/api/v1/jobs/{job_id}/log", { params: { path: { job_id: id } }, signal })),
  });

/** Labels of the kinds of jobs, and where a job leads to. */
export const jobKindsQuery = queryOptions({
  queryKey: ["job-kinds"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/jobs/kinds", { signal })),
  staleTime: Infinity,
});

export const jobsQuery = (filters: { state?: RunState; batch_id?: number }) =>
  queryOptions({
    queryKey: ["jobs", filters],
    queryFn: ({ signal }) => items(api.GET("/api/v1/jobs", { params: { query: filters }, signal })),
    placeholderData: keepPreviousData,
  });

export const queueQuery = queryOptions({
  queryKey: ["queue"],
  queryFn: ({ signal }) => body(api.GET("/api/v1/jobs/status", { signal })),
});

export const batchesQuery = queryOptions({
  queryKey: ["batches"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/batches", { signal })),
});

export const batchQuery = (id: number) =>
  queryOptions({
    queryKey: ["batch", id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/batches/{batch_id}", { params: { path: { batch_id: id } }, signal })),
  });

/** What the server works on: jobs, batches and tasks. */
import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";
import { isLive } from "../live";
import { isOver, type RunState, type Task } from "../types";
import { POLL_MS } from "./habits";

export const jobQuery = (id: number) =>
  queryOptions({
    queryKey: ["job", id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/jobs/{job_id}", { params: { path: { job_id: id } }, signal })),
    refetchInterval: (query) =>
      query.state.data !== undefined && isOver(query.state.data.state)
        ? false
        : isLive()
          ? 4 * POLL_MS
          : POLL_MS,
  });

export const jobLogQuery = (id: number) =>
  queryOptions({
    queryKey: ["job", id, "log"],
    queryFn: ({ signal }) =>
      items(api.GET("/api/v1/jobs/{job_id}/log", { params: { path: { job_id: id } }, signal })),
    refetchInterval: () => (isLive() ? false : 4 * POLL_MS),
  });

export const jobsQuery = (filters: { state?: RunState; batch_id?: number }) =>
  queryOptions({
    queryKey: ["jobs", filters],
    queryFn: ({ signal }) => items(api.GET("/api/v1/jobs", { params: { query: filters }, signal })),
    refetchInterval: () => (isLive() ? false : 2 * POLL_MS),
    placeholderData: keepPreviousData,
  });

export const queueQuery = queryOptions({
  queryKey: ["queue"],
  queryFn: ({ signal }) => body(api.GET("/api/v1/jobs/status", { signal })),
  refetchInterval: 4 * POLL_MS,
});

export const batchesQuery = queryOptions({
  queryKey: ["batches"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/batches", { signal })),
  refetchInterval: () => (isLive() ? false : 4 * POLL_MS),
});

export const batchQuery = (id: number) =>
  queryOptions({
    queryKey: ["batch", id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/batches/{batch_id}", { params: { path: { batch_id: id } }, signal })),
    refetchInterval: () => (isLive() ? false : 2 * POLL_MS),
  });

export const taskQuery = (task: Task) =>
  queryOptions({
    queryKey: ["task", task.id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/tasks/{task_id}", { params: { path: { task_id: task.id } }, signal })),
    initialData: task,
    refetchInterval: (query) =>
      query.state.data?.state === "waiting" || query.state.data?.state === "running" ? 300 : false,
  });

export const tasksQuery = queryOptions({
  queryKey: ["tasks"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/tasks", { signal })),
  refetchInterval: 4 * POLL_MS,
});

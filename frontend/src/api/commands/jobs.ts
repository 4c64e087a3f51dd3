/** Cancels and repeats what the server works on. */
import { useMutation } from "@tanstack/react-query";
import { api, body, json } from "../client";
import type { BatchRequest, Job } from "../types";
import { useRefreshRuns } from "./refresh";

export function useSubmitBatch() {
  return useMutation({
    mutationFn: (request: BatchRequest) => body(api.POST("/api/v1/batches", { body: request })),
    onSettled: useRefreshRuns(),
  });
}

/** Cancels what has not ended of a batch, or asks again for what failed. */
export function useChangeBatch(id: number, action: "cancel" | "retry") {
  const path = { batch_id: id };
  return useMutation({
    mutationFn: () =>
      action === "cancel"
        ? body(api.POST("/api/v1/batches/{batch_id}/cancel", { params: { path } }))
        : body(api.POST("/api/v1/batches/{batch_id}/retry", { params: { path } })),
    onSettled: useRefreshRuns(),
  });
}

export function useRetryJob() {
  return useMutation({
    mutationFn: (id: number) =>
      body(api.POST("/api/v1/jobs/{job_id}/retry", { params: { path: { job_id: id } } })),
    onSettled: useRefreshRuns(),
  });
}

export function useCancelJob() {
  return useMutation({
    mutationFn: (id: number) =>
      body(api.POST("/api/v1/jobs/{job_id}/cancel", { params: { path: { job_id: id } } })),
    onSettled: useRefreshRuns(),
  });
}

/** Prints the report at an address to PDF, as a job. */
export function usePrintReport() {
  return useMutation({
    mutationFn: async (of: string) => (await json(of, { method: "POST" })) as Job,
    onSettled: useRefreshRuns(),
  });
}

/** Backs the database up, as a job. */
export function useRequestBackup() {
  return useMutation({
    mutationFn: () => body(api.POST("/api/v1/backups")),
    onSettled: useRefreshRuns(),
  });
}

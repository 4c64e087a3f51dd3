/** Requests and changes of estimation runs. */
import { useMutation } from "@tanstack/react-query";
import { api, body } from "../client";
import type { RunRequest } from "../types";
import { useRefreshRuns } from "./refresh";

export function useSubmitRuns() {
  return useMutation({
    mutationFn: (requests: RunRequest[]) =>
      Promise.all(requests.map((request) => body(api.POST("/api/v1/runs", { body: request })))),
    onSettled: useRefreshRuns(),
  });
}

export function useDeleteRun() {
  return useMutation({
    mutationFn: (id: number) =>
      body(api.DELETE("/api/v1/runs/{run_id}", { params: { path: { run_id: id } } })),
    onSuccess: useRefreshRuns(),
  });
}

/** What pages change: submit, cancel, import, delete. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body, json } from "./client";
import type { DesignRequest, Maneuver, RunRequest } from "./types";

/** Everything that shows a run: its own page, lists, and the badges of the campaign. */
const RUN_VIEWS = [["runs"], ["run"], ["jobs"], ["job"], ["maneuvers"]];

function useRefreshRuns() {
  const cache = useQueryClient();
  return () => Promise.all(RUN_VIEWS.map((queryKey) => cache.invalidateQueries({ queryKey })));
}

export function useSubmitRuns() {
  return useMutation({
    mutationFn: (requests: RunRequest[]) =>
      Promise.all(requests.map((request) => body(api.POST("/api/v1/runs", { body: request })))),
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

export function useDeleteRun() {
  return useMutation({
    mutationFn: (id: number) =>
      body(api.DELETE("/api/v1/runs/{run_id}", { params: { path: { run_id: id } } })),
    onSuccess: useRefreshRuns(),
  });
}

export interface Import {
  files: File[];
  mapping: File;
}

export function useImportManeuver() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: ({ files, mapping }: Import) => {
      const form = new FormData();
      for (const file of files) form.append("files", file);
      form.append("mapping", mapping);
      return json("/api/v1/maneuvers", { method: "POST", body: form }) as Promise<Maneuver>;
    },
    onSuccess: () => cache.invalidateQueries({ queryKey: ["maneuvers"] }),
  });
}

export function useCreateDesign() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: DesignRequest) => body(api.POST("/api/v1/designs", { body: wanted })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["designs"], exact: true }),
  });
}

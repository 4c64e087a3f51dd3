/** Requests estimation runs. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body } from "../client";
import type { RunRequest, RunTemplate } from "../types";
import { useRefreshRuns } from "./refresh";

export function useSubmitRuns() {
  return useMutation({
    mutationFn: (requests: RunRequest[]) =>
      Promise.all(requests.map((request) => body(api.POST("/api/v1/runs", { body: request })))),
    onSettled: useRefreshRuns(),
  });
}

/** Takes the corrections of the causes that a run names. */
export function useCorrectCause(run: { id: number; maneuver_id: number }) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: () =>
      body(api.POST("/api/v1/runs/{run_id}/corrections", { params: { path: { run_id: run.id } } })),
    onSuccess: () =>
      Promise.all(
        [["conditioning", run.maneuver_id], ["quality"], ["figure"], ["result job"]].map(
          (queryKey) => cache.invalidateQueries({ queryKey }),
        ),
      ),
  });
}

interface SavedTemplate {
  runId: number;
  name: string;
  note: string;
  /** Template of this name, to which a revision is added. */
  present?: RunTemplate;
}

export function useSaveTemplate() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: ({ runId, name, note, present }: SavedTemplate) =>
      present === undefined
        ? body(api.POST("/api/v1/run-templates", { body: { run_id: runId, name, note } }))
        : body(
            api.PUT("/api/v1/run-templates/{run_template_id}", {
              params: { path: { run_template_id: present.id } },
              body: { run_id: runId, revision: present.revision, note },
            }),
          ),
    onSettled: () => cache.invalidateQueries({ queryKey: ["run-templates"] }),
  });
}

export function useDeleteTemplate() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: ({ id, revision }: RunTemplate) =>
      body(
        api.DELETE("/api/v1/run-templates/{run_template_id}", {
          params: { path: { run_template_id: id }, query: { revision } },
        }),
      ),
    onSettled: () => cache.invalidateQueries({ queryKey: ["run-templates"] }),
  });
}

/** Changes many at once, and keeps a list as it is shown. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body } from "../client";
import type { Action, ManyOf, SavedViewRequest } from "../types";
import { RUN_VIEWS } from "./refresh";

/** Deletes, restores, tags or untags many; the answer says which were changed. */
export function useChangeMany(what: ManyOf) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: { ids: number[]; action: Action; tag?: string }) =>
      what === "runs"
        ? body(api.POST("/api/v1/runs/changes", { body: wanted }))
        : body(api.POST("/api/v1/maneuvers/changes", { body: wanted })),
    onSettled: () => {
      // Not waited for: what can be undone is told at once, lists follow.
      for (const key of [...RUN_VIEWS, ["maneuver"], ["ground-tests"], ["figure", "envelope"]]) {
        void cache.invalidateQueries({ queryKey: key });
      }
    },
  });
}

export function useSaveView() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: SavedViewRequest) =>
      body(api.POST("/api/v1/saved-views", { body: wanted })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["saved-views"] }),
  });
}

export function useForgetView() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (id: number) =>
      body(api.DELETE("/api/v1/saved-views/{view_id}", { params: { path: { view_id: id } } })),
    onSettled: () => cache.invalidateQueries({ queryKey: ["saved-views"] }),
  });
}

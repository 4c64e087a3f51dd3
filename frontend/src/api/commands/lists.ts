/** Commands on many records, and saved views. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body } from "../client";
import type { Action, ManyOf, SavedViewRequest } from "../types";
import { RUN_VIEWS } from "./refresh";

/** Deletes, restores, tags or untags many records; the response lists the changed ones. */
export function useChangeMany(records: ManyOf) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: { ids: number[]; action: Action; tag?: string }) =>
      records === "runs"
        ? body(api.POST("/api/v1/runs/changes", { body: request }))
        : body(api.POST("/api/v1/maneuvers/changes", { body: request })),
    onSettled: () => {
      // Not awaited: the notice with undo is shown at once, lists refresh later.
      for (const key of [...RUN_VIEWS, ["maneuver"], ["ground-tests"], ["figure", "envelope"]]) {
        void cache.invalidateQueries({ queryKey: key });
      }
    },
  });
}

export function useSaveView() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: SavedViewRequest) =>
      body(api.POST("/api/v1/saved-views", { body: request })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["saved-views"] }),
  });
}

export function useDeleteView() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (id: number) =>
      body(api.DELETE("/api/v1/saved-views/{view_id}", { params: { path: { view_id: id } } })),
    onSettled: () => cache.invalidateQueries({ queryKey: ["saved-views"] }),
  });
}

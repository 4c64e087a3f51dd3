/** Requests searches for a model structure, and opens their candidates. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body } from "../client";
import type { SearchRequest } from "../types";
import { useRefreshRuns } from "./refresh";

export function useRequestSearch() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: SearchRequest) => body(api.POST("/api/v1/searches", { body: request })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["searches"] }),
  });
}

/** Opens a candidate of a search as a run; the same run every time. */
export function useOpenCandidate(id: number) {
  const cache = useQueryClient();
  const refresh = useRefreshRuns();
  return useMutation({
    mutationFn: (index: number) =>
      body(
        api.POST("/api/v1/searches/{search_id}/candidates/{index}/run", {
          params: { path: { search_id: id, index } },
        }),
      ),
    onSuccess: () =>
      Promise.all([cache.invalidateQueries({ queryKey: ["searches", id] }), refresh()]),
  });
}

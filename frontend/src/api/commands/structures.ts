/** Saves model structures. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body } from "../client";
import type { StructureEditRequest, StructureRequest } from "../types";

export function useAddStructure() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: StructureRequest) =>
      body(api.POST("/api/v1/model-structures", { body: request })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["structures"] }),
  });
}

export function useEditStructure(id: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: StructureEditRequest) =>
      body(
        api.PUT("/api/v1/model-structures/{structure_id}", {
          params: { path: { structure_id: id } },
          body: request,
        }),
      ),
    onSettled: () => cache.invalidateQueries({ queryKey: ["structures"] }),
  });
}

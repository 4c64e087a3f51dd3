/** Model structures and their versions. */
import { queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";

export const structuresQuery = (aircraftId?: number) =>
  queryOptions({
    queryKey: ["structures", "list", aircraftId],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/model-structures", {
          params: { query: { aircraft_id: aircraftId } },
          signal,
        }),
      ),
  });

/** The newest version; colleagues may save another at any time. */
export const structureQuery = (id: number) =>
  queryOptions({
    queryKey: ["structures", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/model-structures/{structure_id}", {
          params: { path: { structure_id: id } },
          signal,
        }),
      ),
  });

export const structureVersionsQuery = (id: number) =>
  queryOptions({
    queryKey: ["structures", id, "versions"],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/model-structures/{structure_id}/versions", {
          params: { path: { structure_id: id } },
          signal,
        }),
      ),
  });

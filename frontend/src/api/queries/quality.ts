/** How good the data of maneuvers is. */
import { queryOptions } from "@tanstack/react-query";
import { api, body } from "../client";

export const qualityQuery = (id: number) =>
  queryOptions({
    queryKey: ["quality", "maneuver", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/maneuvers/{maneuver_id}/quality", {
          params: { path: { maneuver_id: id } },
          signal,
        }),
      ),
    staleTime: 60_000,
  });

/** Number of maneuvers by verdict, and the progress of their assessment. */
export const assessmentQuery = queryOptions({
  queryKey: ["quality", "list"],
  queryFn: ({ signal }) =>
    body(api.GET("/api/v1/quality", { params: { query: { limit: 1 } }, signal })),
});

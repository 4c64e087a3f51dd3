/** The aircraft, and what was predicted of it. */
import { queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";

export const aircraftQuery = queryOptions({
  queryKey: ["aircraft"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/aircraft", { signal })),
});

export const dashboardQuery = (aircraftId: number) =>
  queryOptions({
    queryKey: ["dashboard", aircraftId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/aircraft/{aircraft_id}/dashboard", {
          params: { path: { aircraft_id: aircraftId } },
          signal,
        }),
      ),
  });

export const predictionsQuery = (aircraftId?: number) =>
  queryOptions({
    queryKey: ["predictions", aircraftId],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/predictions", {
          params: { query: { aircraft_id: aircraftId } },
          signal,
        }),
      ),
  });

/** Maneuvers of a campaign with one multisine at several amplitudes, and their runs. */
export const repeatedLevelsQuery = (aircraftId: number) =>
  queryOptions({
    queryKey: ["repeated-levels", aircraftId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/aircraft/{aircraft_id}/repeated-levels", {
          params: { path: { aircraft_id: aircraftId } },
          signal,
        }),
      ),
    select: (page) => page.items,
  });

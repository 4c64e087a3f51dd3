/** Flight conditions, and the sheet of evidence of each. */
import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";

export const conditionsQuery = (aircraft?: number) =>
  queryOptions({
    queryKey: ["conditions", "list", aircraft],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/conditions", { params: { query: { aircraft_id: aircraft } }, signal }),
      ),
  });

/** The sheet rests on runs, decisions and stored results: any of their events refreshes it. */
export const conditionSheetQuery = (id: number, truth = false, frozen?: number) =>
  queryOptions({
    queryKey: ["conditions", id, truth, frozen],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/conditions/{condition_id}/sheet", {
          params: {
            path: { condition_id: id },
            query: { ...(truth ? { truth } : {}), figure_id: frozen },
          },
          signal,
        }),
      ),
    placeholderData: keepPreviousData,
  });

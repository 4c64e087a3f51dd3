/** Measured responses of a vibration test, and the modes in them. */
import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";

export const measuredResponsesQuery = (aircraftId: number) =>
  queryOptions({
    queryKey: ["measured-responses", aircraftId],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/measured-responses", {
          params: { query: { aircraft_id: aircraftId } },
          signal,
        }),
      ),
  });

export const foundModesQuery = (
  id: number,
  query: { low_hz?: number; high_hz?: number; order: number },
) =>
  queryOptions({
    queryKey: ["measured-responses", "modes", id, query],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/measured-responses/{responses_id}/modes", {
          params: { path: { responses_id: id }, query },
          signal,
        }),
      ),
    placeholderData: keepPreviousData,
    retry: false,
  });

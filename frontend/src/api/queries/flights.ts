/** Flights and ground tests as they were recorded. */
import { queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";

export const flightsQuery = queryOptions({
  queryKey: ["flights"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/flights", { signal })),
});

export const flightQuery = (id: number) =>
  queryOptions({
    queryKey: ["flight", id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/flights/{flight_id}", { params: { path: { flight_id: id } }, signal })),
  });

export const flightChannelsQuery = (id: number) =>
  queryOptions({
    queryKey: ["flight", id, "channels"],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/flights/{flight_id}/channels", {
          params: { path: { flight_id: id } },
          signal,
        }),
      ),
    staleTime: 60_000,
  });

export const maneuverProposalsQuery = (id: number) =>
  queryOptions({
    queryKey: ["flight", id, "found"],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/flights/{flight_id}/maneuver-proposals", {
          params: { path: { flight_id: id } },
          signal,
        }),
      ),
    staleTime: 60_000,
    retry: false,
  });

export const groundTestsQuery = queryOptions({
  queryKey: ["ground-tests"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/ground-tests", { signal })),
  staleTime: 60_000,
});

export const groundTestQuery = (flightId: number) =>
  queryOptions({
    queryKey: ["ground-test", flightId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/ground-tests/{flight_id}", {
          params: { path: { flight_id: flightId } },
          signal,
        }),
      ),
  });

/** How good the data of maneuvers is. */
import { infiniteQueryOptions, queryOptions } from "@tanstack/react-query";
import { api, body } from "../client";
import { PAGED } from "./habits";

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

interface QualityFilters {
  verdict?: "good" | "questionable" | "bad" | "unchecked" | "missing";
  flight_id?: number;
  search?: string;
}

export const qualitiesQuery = (filters: QualityFilters, sort: string) =>
  infiniteQueryOptions({
    queryKey: ["quality", "list", filters, sort],
    queryFn: ({ pageParam, signal }) =>
      body(
        api.GET("/api/v1/quality", {
          params: { query: { ...filters, sort, limit: 200, after: pageParam } },
          signal,
        }),
      ),
    ...PAGED,
  });

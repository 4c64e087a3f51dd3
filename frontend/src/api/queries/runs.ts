/** Estimation runs, and what they are compared with. */
import { infiniteQueryOptions, keepPreviousData, queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";
import type { DerivativeTrend, RunFilters } from "../types";
import { PAGED } from "./habits";

export const runListQuery = (filters: RunFilters, sort: string, limit = 50) =>
  infiniteQueryOptions({
    queryKey: ["runs", "list", filters, sort, limit],
    queryFn: ({ pageParam, signal }) =>
      body(
        api.GET("/api/v1/runs", {
          params: { query: { ...filters, sort, limit, after: pageParam } },
          signal,
        }),
      ),
    ...PAGED,
  });

export const runFacetsQuery = (filters: RunFilters) =>
  queryOptions({
    queryKey: ["runs", "facets", filters],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/runs/facets", { params: { query: filters }, signal })),
    placeholderData: keepPreviousData,
  });

export const runsQuery = (filters: RunFilters) =>
  queryOptions({
    queryKey: ["runs", filters],
    queryFn: ({ signal }) =>
      items(api.GET("/api/v1/runs", { params: { query: { ...filters, limit: 200 } }, signal })),
  });

export const runTemplatesQuery = (aircraft?: number) =>
  queryOptions({
    queryKey: ["run-templates", aircraft],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/run-templates", { params: { query: { aircraft_id: aircraft } }, signal }),
      ),
  });

export const runQuery = (id: number) =>
  queryOptions({
    queryKey: ["run", id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/runs/{run_id}", { params: { path: { run_id: id } }, signal })),
  });

export const comparisonQuery = (runs: readonly number[], predictions: readonly number[]) =>
  queryOptions({
    queryKey: ["comparison", runs, predictions],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/comparisons", {
          params: { query: { run_ids: runs.join(","), prediction_ids: predictions.join(",") } },
          signal,
        }),
      ),
    enabled: runs.length > 0,
    placeholderData: keepPreviousData,
  });

interface TrendParams {
  run_ids: string;
  prediction_ids?: string;
  name: string;
  against: DerivativeTrend["against"];
  degree: number;
}

export const trendQuery = (query: TrendParams) =>
  queryOptions({
    queryKey: ["trend", query],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/comparisons/trend", { params: { query: query }, signal })),
    placeholderData: keepPreviousData,
  });

/** Damping, the margin to flutter, and the loop that a controller closes. */
import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";

export interface FlutterParams {
  run_ids: string;
  fuel?: number;
  altitude_m?: number;
  next_m_s?: number;
  others?: "residualized";
  trend?: boolean;
}

export const flutterQuery = (query: FlutterParams, ready = true) =>
  queryOptions({
    queryKey: ["flutter", query],
    queryFn: ({ signal }) => body(api.GET("/api/v1/flutter", { params: { query: query }, signal })),
    enabled: ready && query.run_ids !== "",
    placeholderData: keepPreviousData,
    staleTime: 60_000,
  });

/** Starts the flutter prediction of many runs; once for each set of parameters. */
export const flutterTaskQuery = (query: FlutterParams, enabled: boolean) =>
  queryOptions({
    queryKey: ["flutter-task", query],
    queryFn: ({ signal }) =>
      body(api.POST("/api/v1/flutter/results", { params: { query: query }, signal })),
    enabled,
    staleTime: Infinity,
    gcTime: 0,
  });

export const controllersQuery = queryOptions({
  queryKey: ["controllers"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/controllers", { signal })),
});

/** Starts the closed-loop analysis of many runs; once for each set of parameters. */
export const closedLoopTaskQuery = (
  query: FlutterParams,
  controllerId: number | undefined,
  enabled: boolean,
) =>
  queryOptions({
    queryKey: ["closed-loop-task", query, controllerId],
    queryFn: ({ signal }) =>
      body(
        api.POST("/api/v1/closed-loop/results", {
          params: { query: { ...query, controller_id: controllerId ?? 0 } },
          signal,
        }),
      ),
    enabled: enabled && controllerId !== undefined,
    staleTime: Infinity,
    gcTime: 0,
  });

export const closedLoopQuery = (
  query: FlutterParams,
  controllerId: number | undefined,
  enabled = true,
) =>
  queryOptions({
    queryKey: ["closed-loop", query, controllerId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/closed-loop", {
          params: { query: { ...query, controller_id: controllerId ?? 0 } },
          signal,
        }),
      ),
    enabled: enabled && query.run_ids !== "" && controllerId !== undefined,
    placeholderData: keepPreviousData,
    staleTime: 60_000,
  });

/** Damping, the margin to flutter, and the loop that a controller closes. */
import { queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";
import type { StoredResultOptions } from "../useStoredResult";
import type { ClosedLoopStability, Flutter, PredictedFlutter } from "../types";

export interface FlutterParams {
  run_ids: string;
  fuel?: number;
  altitude_m?: number;
  next_m_s?: number;
  unmodelled_modes?: "residualized";
  variation?: "linear" | "global-model";
}

/** The flutter prediction; an equal request is the same job. */
export const flutterResult = (query: FlutterParams): StoredResultOptions<Flutter> => {
  const params = { query };
  return {
    key: ["flutter", query],
    enabled: query.run_ids !== "",
    read: (signal) => body(api.GET("/api/v1/flutter", { params, signal })),
    find: (signal) => body(api.GET("/api/v1/flutter/results", { params, signal })),
    submit: () => body(api.POST("/api/v1/flutter/results", { params })),
  };
};

export interface PredictedFlutterParams {
  prediction_id: number;
  axis?: "longitudinal" | "lateral";
  fuel?: number;
  density_kg_m3?: number;
  from_m_s?: number;
  to_m_s?: number;
}

/** The flutter analysis of a prediction alone; an equal request is the same job. */
export const predictedFlutterResult = (
  query: PredictedFlutterParams | undefined,
): StoredResultOptions<PredictedFlutter> => {
  const params = { query: query ?? { prediction_id: 0 } };
  return {
    key: ["predicted-flutter", query],
    enabled: query !== undefined,
    read: (signal) => body(api.GET("/api/v1/flutter/predicted", { params, signal })),
    find: (signal) => body(api.GET("/api/v1/flutter/predicted/results", { params, signal })),
    submit: () => body(api.POST("/api/v1/flutter/predicted/results", { params })),
  };
};

export const controllersQuery = queryOptions({
  queryKey: ["controllers"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/controllers", { signal })),
});

/** The closed-loop analysis; an equal request is the same job. */
export const closedLoopResult = (
  query: FlutterParams,
  controllerId: number | undefined,
): StoredResultOptions<ClosedLoopStability> => {
  const params = { query: { ...query, controller_id: controllerId ?? 0 } };
  return {
    key: ["closed-loop", query, controllerId],
    enabled: query.run_ids !== "" && controllerId !== undefined,
    read: (signal) => body(api.GET("/api/v1/closed-loop", { params, signal })),
    find: (signal) => body(api.GET("/api/v1/closed-loop/results", { params, signal })),
    submit: () => body(api.POST("/api/v1/closed-loop/results", { params })),
  };
};

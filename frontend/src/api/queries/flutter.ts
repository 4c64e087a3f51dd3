/** Damping, the margin to flutter, and the loop that a controller closes. */
import { queryOptions } from "@tanstack/react-query";
import { api, items } from "../client";
import { storedResult, type AnalysisQuery } from "../storedResult";

export type FlutterParams = AnalysisQuery<"/api/v1/flutter">;

/** The flutter prediction; an equal request is the same job. */
export const flutterResult = (query: FlutterParams) =>
  storedResult("/api/v1/flutter", { query }, query.run_ids !== "");

/** The flutter analysis of a prediction alone; an equal request is the same job. */
export const predictedFlutterResult = (
  query: AnalysisQuery<"/api/v1/flutter/predicted"> | undefined,
) =>
  storedResult(
    "/api/v1/flutter/predicted",
    { query: query ?? { prediction_id: 0 } },
    query !== undefined,
  );

export const controllersQuery = queryOptions({
  queryKey: ["controllers"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/controllers", { signal })),
});

/** The closed-loop analysis; an equal request is the same job. */
export const closedLoopResult = (query: FlutterParams, controllerId: number | undefined) =>
  storedResult(
    "/api/v1/closed-loop",
    { query: { ...query, controller_id: controllerId ?? 0 } },
    query.run_ids !== "" && controllerId !== undefined,
  );

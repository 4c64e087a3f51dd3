/** Damping, the margin to flutter, and the loop that a controller closes. */
import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";

export interface FlutterQuestion {
  run_ids: string;
  fuel?: number;
  altitude_m?: number;
  next_m_s?: number;
  others?: "residualized";
  trend?: boolean;
}

export const flutterQuery = (question: FlutterQuestion, ready = true) =>
  queryOptions({
    queryKey: ["flutter", question],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/flutter", { params: { query: question }, signal })),
    enabled: ready && question.run_ids !== "",
    placeholderData: keepPreviousData,
    staleTime: 60_000,
  });

/** Begins to find the answer for many runs; once for a question while the page stands. */
export const flutterTaskQuery = (question: FlutterQuestion, enabled: boolean) =>
  queryOptions({
    queryKey: ["flutter-task", question],
    queryFn: ({ signal }) =>
      body(api.POST("/api/v1/flutter/answers", { params: { query: question }, signal })),
    enabled,
    staleTime: Infinity,
    gcTime: 0,
  });

export const controllersQuery = queryOptions({
  queryKey: ["controllers"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/controllers", { signal })),
});

/** Begins to find the closed loop of many runs; once for a question while the page stands. */
export const closedLoopTaskQuery = (
  question: FlutterQuestion,
  controllerId: number | undefined,
  enabled: boolean,
) =>
  queryOptions({
    queryKey: ["closed-loop-task", question, controllerId],
    queryFn: ({ signal }) =>
      body(
        api.POST("/api/v1/closed-loop/answers", {
          params: { query: { ...question, controller_id: controllerId ?? 0 } },
          signal,
        }),
      ),
    enabled: enabled && controllerId !== undefined,
    staleTime: Infinity,
    gcTime: 0,
  });

export const closedLoopQuery = (
  question: FlutterQuestion,
  controllerId: number | undefined,
  enabled = true,
) =>
  queryOptions({
    queryKey: ["closed-loop", question, controllerId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/closed-loop", {
          params: { query: { ...question, controller_id: controllerId ?? 0 } },
          signal,
        }),
      ),
    enabled: enabled && question.run_ids !== "" && controllerId !== undefined,
    placeholderData: keepPreviousData,
    staleTime: 60_000,
  });

/** Global aerodynamic model: derivatives over the envelope from the estimates of all runs. */
import { queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";
import { storedResult, type AnalysisQuery } from "../storedResult";

export type GlobalModelParams = AnalysisQuery<"/api/v1/global-models">;

/** The global model of runs; an equal request is the same job. */
export const globalModelResult = (query: GlobalModelParams) =>
  storedResult("/api/v1/global-models", { query }, query.run_ids !== "" && query.variables !== "");

export const globalModelVersionsQuery = (aircraft_id?: number) =>
  queryOptions({
    queryKey: ["global-models", "versions", aircraft_id],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/global-models/versions", { params: { query: { aircraft_id } }, signal }),
      ),
  });

export const globalModelVersionQuery = (id: number) =>
  queryOptions({
    queryKey: ["global-models", "version", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/global-models/versions/{global_model_id}", {
          params: { path: { global_model_id: id } },
          signal,
        }),
      ),
  });

/** What a version changes of another. */
export const globalModelDifferencesQuery = (id: number, base: number) =>
  queryOptions({
    queryKey: ["global-models", "differences", id, base],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/global-models/versions/{global_model_id}/differences", {
          params: { path: { global_model_id: id }, query: { base_global_model_id: base } },
          signal,
        }),
      ),
  });

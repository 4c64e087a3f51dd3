/** Global aerodynamic model: derivatives over the envelope from the estimates of all runs. */
import { api, body } from "../client";
import type { StoredResultOptions } from "../useStoredResult";
import type { GlobalModelSummary } from "../types";

export interface GlobalModelParams {
  run_ids: string;
  variables: string;
  prediction_id?: number;
}

/** The global model of runs; an equal request is the same job. */
export const globalModelResult = (
  query: GlobalModelParams,
): StoredResultOptions<GlobalModelSummary> => {
  const params = { query };
  return {
    key: ["global-models", query],
    enabled: query.run_ids !== "" && query.variables !== "",
    read: (signal) => body(api.GET("/api/v1/global-models", { params, signal })),
    find: (signal) => body(api.GET("/api/v1/global-models/results", { params, signal })),
    submit: () => body(api.POST("/api/v1/global-models/results", { params })),
  };
};

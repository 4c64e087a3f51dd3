/** Predictions of maneuvers by the models of runs, and of held-out data by refits. */
import { api, body } from "../client";
import type { StoredResultOptions } from "../useStoredResult";
import type {
  AerodynamicsComparison,
  CrossPredictionMatrix,
  CrossValidationSummary,
  PosteriorCheck,
} from "../types";

export interface CrossPredictionParams {
  run_ids: string;
  maneuver_ids?: string;
}

/** The matrix of cross-predictions; an equal request is the same job. */
export const crossPredictionResult = (
  query: CrossPredictionParams,
): StoredResultOptions<CrossPredictionMatrix> => {
  const params = { query };
  return {
    key: ["cross-predictions", query],
    enabled: query.run_ids !== "",
    read: (signal) => body(api.GET("/api/v1/cross-predictions", { params, signal })),
    find: (signal) => body(api.GET("/api/v1/cross-predictions/results", { params, signal })),
    submit: () => body(api.POST("/api/v1/cross-predictions/results", { params })),
  };
};

export interface CrossValidationParams {
  run_id: number;
  partition: "folds" | "frequencies" | "periods";
  folds?: number;
}

/** The cross-validation of a run; an equal request is the same job. */
export const crossValidationResult = (
  query: CrossValidationParams,
): StoredResultOptions<CrossValidationSummary> => {
  const params = { query };
  return {
    key: ["cross-validations", query],
    enabled: true,
    read: (signal) => body(api.GET("/api/v1/cross-validations", { params, signal })),
    find: (signal) => body(api.GET("/api/v1/cross-validations/results", { params, signal })),
    submit: () => body(api.POST("/api/v1/cross-validations/results", { params })),
  };
};

/** Quasi-steady against shaped derivatives on the data of a run; computed where `requested`. */
export const aerodynamicsResult = (
  runId: number,
  requested: boolean,
): StoredResultOptions<AerodynamicsComparison> => {
  const params = { query: { run_id: runId } };
  return {
    key: ["aerodynamics-comparisons", runId],
    enabled: requested,
    read: (signal) => body(api.GET("/api/v1/aerodynamics-comparisons", { params, signal })),
    find: (signal) => body(api.GET("/api/v1/aerodynamics-comparisons/results", { params, signal })),
    submit: () => body(api.POST("/api/v1/aerodynamics-comparisons/results", { params })),
  };
};

/** The posterior of an output-error run against its standard errors; computed where `requested`. */
export const posteriorResult = (
  runId: number,
  requested: boolean,
): StoredResultOptions<PosteriorCheck> => {
  const params = { query: { run_id: runId } };
  return {
    key: ["posterior-checks", runId],
    enabled: requested,
    read: (signal) => body(api.GET("/api/v1/posterior-checks", { params, signal })),
    find: (signal) => body(api.GET("/api/v1/posterior-checks/results", { params, signal })),
    submit: () => body(api.POST("/api/v1/posterior-checks/results", { params })),
  };
};

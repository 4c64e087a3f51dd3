/** Predictions of maneuvers by the models of runs, and of held-out data by refits. */
import { storedResult } from "../storedResult";

export interface CrossPredictionParams {
  run_ids: string;
  maneuver_ids?: string;
}

/** The matrix of cross-predictions; an equal request is the same job. */
export const crossPredictionResult = (query: CrossPredictionParams) =>
  storedResult("/api/v1/cross-predictions", { query }, query.run_ids !== "");

export interface CrossValidationParams {
  run_id: number;
  partition: "folds" | "frequencies" | "periods";
  folds?: number;
}

/** The cross-validation of a run; an equal request is the same job. */
export const crossValidationResult = (query: CrossValidationParams) =>
  storedResult("/api/v1/cross-validations", { query });

/** Quasi-steady against shaped derivatives on the data of a run; computed where `requested`. */
export const aerodynamicsResult = (runId: number, requested: boolean) =>
  storedResult("/api/v1/aerodynamics-comparisons", { query: { run_id: runId } }, requested);

/** The posterior of an output-error run against its standard errors; computed where `requested`. */
export const posteriorResult = (runId: number, requested: boolean) =>
  storedResult("/api/v1/posterior-checks", { query: { run_id: runId } }, requested);

/** Tests of equal linear models at the amplitudes of output-error runs. */
export const amplitudeResult = (runs: readonly number[]) =>
  storedResult("/api/v1/amplitude-comparisons", { query: { run_ids: runs.join(",") } });

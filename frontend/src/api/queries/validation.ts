/** Predictions of maneuvers by the models of runs. */
import { storedResult, type AnalysisQuery } from "../storedResult";

/** The matrix of cross-predictions; an equal request is the same job. */
export const crossPredictionResult = (query: AnalysisQuery<"/api/v1/cross-predictions">) =>
  storedResult("/api/v1/cross-predictions", { query }, query.run_ids !== "");

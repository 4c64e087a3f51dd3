/** Excitation designs and what is expected of them. */
import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";
import { storedResult } from "../storedResult";

export const designsQuery = queryOptions({
  queryKey: ["designs"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/designs", { signal })),
});

export const designQuery = (id: number) =>
  queryOptions({
    queryKey: ["designs", id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/designs/{design_id}", { params: { path: { design_id: id } }, signal })),
  });

export const catalogueQuery = queryOptions({
  queryKey: ["designs", "catalogue"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/designs/catalogue", { signal })),
  staleTime: Infinity,
});

export const targetModesQuery = (
  id: number,
  aircraftId: number | undefined,
  airspeed: number | undefined,
) =>
  queryOptions({
    queryKey: ["designs", id, "targets", aircraftId, airspeed],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/designs/{design_id}/target-modes", {
          params: {
            path: { design_id: id },
            query: { aircraft_id: aircraftId ?? 0, airspeed_m_s: airspeed },
          },
          signal,
        }),
      ),
    enabled: aircraftId !== undefined,
  });

export interface RowCondition {
  aircraft_id: number;
  airspeed_m_s?: number | undefined;
  period_s: number;
  first_harmonic: number;
}

/** Target modes of every row of the catalogue on an aircraft. */
export const rowTargetsQuery = (condition: RowCondition | null) =>
  queryOptions({
    queryKey: ["designs", "catalogue", "targets", condition],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/designs/catalogue/targets", {
          params: { query: condition ?? { aircraft_id: 0, period_s: 1 } },
          signal,
        }),
      ),
    enabled: condition !== null,
    placeholderData: keepPreviousData,
  });

export interface Actuator {
  natural_frequency: number;
  position?: number;
  rate?: number;
}

export const designChecksQuery = (id: number, level: number, actuator: Actuator) =>
  queryOptions({
    queryKey: ["designs", id, "checks", level, actuator],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/designs/{design_id}/checks", {
          params: { path: { design_id: id }, query: { ...actuator, level } },
          signal,
        }),
      ),
    placeholderData: keepPreviousData,
  });

/** Predicted standard errors, and the response that they rest on. */
export const predictedAccuracyResult = (id: number, level: number, runId: number) => {
  const params = { path: { design_id: id }, query: { run_id: runId, level } };
  return storedResult(
    "/api/v1/designs/{design_id}/predicted-accuracy",
    params,
    true,
    async (signal) => {
      const [errors, response] = await Promise.all([
        body(api.GET("/api/v1/designs/{design_id}/expected-errors", { params, signal })),
        body(api.GET("/api/v1/designs/{design_id}/expected-response", { params, signal })),
      ]);
      return { errors, response };
    },
  );
};

export const preflightSimulationsQuery = (designId: number) =>
  queryOptions({
    queryKey: ["designs", designId, "preflight_simulations"],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/designs/{design_id}/preflight-simulations", {
          params: { path: { design_id: designId } },
          signal,
        }),
      ),
  });

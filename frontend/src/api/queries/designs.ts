/** Excitation designs and what is expected of them. */
import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";
import { isOver } from "../types";
import { POLL_MS } from "./habits";

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

export const targetModesQuery = (id: number, aircraftId: number | undefined) =>
  queryOptions({
    queryKey: ["designs", id, "targets", aircraftId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/designs/{design_id}/target-modes", {
          params: { path: { design_id: id }, query: { aircraft_id: aircraftId ?? 0 } },
          signal,
        }),
      ),
    enabled: aircraftId !== undefined,
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

export const expectedErrorsQuery = (id: number, level: number, runId: number | undefined) =>
  queryOptions({
    queryKey: ["designs", id, "expected", level, runId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/designs/{design_id}/expected-errors", {
          params: { path: { design_id: id }, query: { run_id: runId ?? 0, level } },
          signal,
        }),
      ),
    enabled: runId !== undefined,
  });

export const expectedResponseQuery = (id: number, level: number, runId: number) =>
  queryOptions({
    queryKey: ["designs", id, "response", level, runId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/designs/{design_id}/expected-response", {
          params: { path: { design_id: id }, query: { run_id: runId, level } },
          signal,
        }),
      ),
  });

export const classicInputsQuery = (id: number, level: number, runId: number) =>
  queryOptions({
    queryKey: ["designs", id, "classic", level, runId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/designs/{design_id}/classic-inputs", {
          params: { path: { design_id: id }, query: { run_id: runId, level } },
          signal,
        }),
      ),
    staleTime: Infinity,
  });

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
    refetchInterval: (query) =>
      query.state.data?.some((one) => !isOver(one.state)) === true ? 3 * POLL_MS : false,
  });

export interface AmplitudeLimits {
  /** Largest deflection [rad] and load factor [g]; the design's own where undefined. */
  deflection?: number;
  load_factor?: number;
}

export const amplitudesQuery = (
  id: number,
  level: number,
  runId: number | undefined,
  limits: AmplitudeLimits,
) =>
  queryOptions({
    queryKey: ["designs", id, "amplitudes", level, runId, limits],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/designs/{design_id}/amplitudes", {
          params: { path: { design_id: id }, query: { run_id: runId ?? 0, level, ...limits } },
          signal,
        }),
      ),
    enabled: runId !== undefined,
    staleTime: 60_000,
  });

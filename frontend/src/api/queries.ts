/** What pages read: one query per resource. Pages and tests share these keys. */
import { infiniteQueryOptions, keepPreviousData, queryOptions } from "@tanstack/react-query";
import { isLive } from "./live";
import { address, api, body, json, type QueryValue } from "./client";
import {
  isOver,
  type DerivativeTrend,
  type FigureSpec,
  type ManeuverFilters,
  type RunFilters,
  type RunState,
  type Task,
} from "./types";

const POLL_MS = 500;

export const healthQuery = queryOptions({
  queryKey: ["health"],
  queryFn: ({ signal }) => body(api.GET("/api/v1/health", { signal })),
  refetchInterval: (query) => (query.state.status === "error" ? 1500 : 10_000),
  retry: false,
});

export const maneuversQuery = (filters: ManeuverFilters, sort: string, limit = 50) =>
  infiniteQueryOptions({
    queryKey: ["maneuvers", filters, sort, limit],
    queryFn: ({ pageParam, signal }) =>
      body(
        api.GET("/api/v1/maneuvers", {
          params: { query: { ...filters, sort, limit, after: pageParam } },
          signal,
        }),
      ),
    initialPageParam: undefined as string | undefined,
    getNextPageParam: (page) => page.next ?? undefined,
    placeholderData: keepPreviousData,
  });

export const maneuverQuery = (id: number) =>
  queryOptions({
    queryKey: ["maneuver", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/maneuvers/{maneuver_id}", {
          params: { path: { maneuver_id: id } },
          signal,
        }),
      ),
  });

export const qualityQuery = (id: number) =>
  queryOptions({
    queryKey: ["quality", "maneuver", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/maneuvers/{maneuver_id}/quality", {
          params: { path: { maneuver_id: id } },
          signal,
        }),
      ),
    staleTime: 60_000,
  });

export const conditioningQuery = (id: number) =>
  queryOptions({
    queryKey: ["conditioning", id],
    queryFn: async ({ signal }) =>
      (
        await body(
          api.GET("/api/v1/maneuvers/{maneuver_id}/conditioning", {
            params: { path: { maneuver_id: id } },
            signal,
          }),
        )
      ).items,
  });

export interface QualityFilters {
  verdict?: "good" | "doubtful" | "bad" | "missing";
  flight_id?: number;
  search?: string;
}

export const qualitiesQuery = (filters: QualityFilters, sort: string) =>
  infiniteQueryOptions({
    queryKey: ["quality", "list", filters, sort],
    queryFn: ({ pageParam, signal }) =>
      body(
        api.GET("/api/v1/quality", {
          params: { query: { ...filters, sort, limit: 200, after: pageParam } },
          signal,
        }),
      ),
    initialPageParam: undefined as string | undefined,
    getNextPageParam: (page) => page.next ?? undefined,
    placeholderData: keepPreviousData,
    refetchInterval: (query) =>
      query.state.data?.pages[0]?.assessing.running === true ? 4 * POLL_MS : false,
  });

export const flightsQuery = queryOptions({
  queryKey: ["flights"],
  queryFn: async ({ signal }) => (await body(api.GET("/api/v1/flights", { signal }))).items,
});

export const flightQuery = (id: number) =>
  queryOptions({
    queryKey: ["flight", id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/flights/{flight_id}", { params: { path: { flight_id: id } }, signal })),
  });

export const flightChannelsQuery = (id: number) =>
  queryOptions({
    queryKey: ["flight", id, "channels"],
    queryFn: async ({ signal }) =>
      (
        await body(
          api.GET("/api/v1/flights/{flight_id}/channels", {
            params: { path: { flight_id: id } },
            signal,
          }),
        )
      ).items,
    staleTime: 60_000,
  });

export const foundManeuversQuery = (id: number) =>
  queryOptions({
    queryKey: ["flight", id, "found"],
    queryFn: async ({ signal }) =>
      (
        await body(
          api.GET("/api/v1/flights/{flight_id}/found-maneuvers", {
            params: { path: { flight_id: id } },
            signal,
          }),
        )
      ).items,
    staleTime: 60_000,
    retry: false,
  });

export const groundTestsQuery = queryOptions({
  queryKey: ["ground-tests"],
  queryFn: async ({ signal }) => (await body(api.GET("/api/v1/ground-tests", { signal }))).items,
  staleTime: 60_000,
});

export const groundTestQuery = (flightId: number) =>
  queryOptions({
    queryKey: ["ground-test", flightId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/ground-tests/{flight_id}", {
          params: { path: { flight_id: flightId } },
          signal,
        }),
      ),
  });

export const aircraftQuery = queryOptions({
  queryKey: ["aircraft"],
  queryFn: async ({ signal }) => (await body(api.GET("/api/v1/aircraft", { signal }))).items,
});

export const modalTablesQuery = (aircraftId: number) =>
  queryOptions({
    queryKey: ["modal-tables", aircraftId],
    queryFn: async ({ signal }) =>
      (
        await body(
          api.GET("/api/v1/modal-tables", {
            params: { query: { aircraft_id: aircraftId } },
            signal,
          }),
        )
      ).items,
  });

export const modalTableQuery = (id: number) =>
  queryOptions({
    queryKey: ["modal-table", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/modal-tables/{modal_table_id}", {
          params: { path: { modal_table_id: id } },
          signal,
        }),
      ),
  });

export const predictionsQuery = (aircraftId?: number) =>
  queryOptions({
    queryKey: ["predictions", aircraftId],
    queryFn: async ({ signal }) =>
      (
        await body(
          api.GET("/api/v1/predictions", {
            params: { query: { aircraft_id: aircraftId } },
            signal,
          }),
        )
      ).items,
  });

export const runListQuery = (filters: RunFilters, sort: string, limit = 50) =>
  infiniteQueryOptions({
    queryKey: ["runs", "list", filters, sort, limit],
    queryFn: ({ pageParam, signal }) =>
      body(
        api.GET("/api/v1/runs", {
          params: { query: { ...filters, sort, limit, after: pageParam } },
          signal,
        }),
      ),
    initialPageParam: undefined as string | undefined,
    getNextPageParam: (page) => page.next ?? undefined,
    placeholderData: keepPreviousData,
    refetchInterval: (query) =>
      query.state.data?.pages.some((page) => page.items.some((run) => !isOver(run.state))) === true
        ? 4 * POLL_MS
        : false,
  });

export const runFacetsQuery = (filters: RunFilters) =>
  queryOptions({
    queryKey: ["runs", "facets", filters],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/runs/facets", { params: { query: filters }, signal })),
    placeholderData: keepPreviousData,
  });

export const maneuverFacetsQuery = (filters: ManeuverFilters) =>
  queryOptions({
    queryKey: ["maneuvers", "facets", filters],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/maneuvers/facets", { params: { query: filters }, signal })),
    placeholderData: keepPreviousData,
  });

export const savedViewsQuery = (page: string) =>
  queryOptions({
    queryKey: ["saved-views", page],
    queryFn: async ({ signal }) =>
      (await body(api.GET("/api/v1/saved-views", { params: { query: { page } }, signal }))).items,
  });

export const meaningQuery = (name: string) =>
  queryOptions({
    queryKey: ["nomenclature", name],
    queryFn: async ({ signal }) =>
      (await body(api.GET("/api/v1/nomenclature", { params: { query: { names: name } }, signal })))
        .items[0] ?? null,
    staleTime: Infinity,
  });

export const glossaryQuery = queryOptions({
  queryKey: ["nomenclature"],
  queryFn: async ({ signal }) => (await body(api.GET("/api/v1/nomenclature", { signal }))).items,
  staleTime: Infinity,
});

export const runsQuery = (filters: RunFilters) =>
  queryOptions({
    queryKey: ["runs", filters],
    queryFn: async ({ signal }) =>
      (
        await body(
          api.GET("/api/v1/runs", { params: { query: { ...filters, limit: 200 } }, signal }),
        )
      ).items,
    refetchInterval: (query) =>
      query.state.data?.some((run) => !isOver(run.state)) === true ? 2 * POLL_MS : false,
  });

export const runQuery = (id: number) =>
  queryOptions({
    queryKey: ["run", id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/runs/{run_id}", { params: { path: { run_id: id } }, signal })),
  });

export const jobQuery = (id: number) =>
  queryOptions({
    queryKey: ["job", id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/jobs/{job_id}", { params: { path: { job_id: id } }, signal })),
    refetchInterval: (query) =>
      query.state.data !== undefined && isOver(query.state.data.state)
        ? false
        : isLive()
          ? 4 * POLL_MS
          : POLL_MS,
  });

export const jobLogQuery = (id: number) =>
  queryOptions({
    queryKey: ["job", id, "log"],
    queryFn: async ({ signal }) =>
      (
        await body(
          api.GET("/api/v1/jobs/{job_id}/log", { params: { path: { job_id: id } }, signal }),
        )
      ).items,
    refetchInterval: () => (isLive() ? false : 4 * POLL_MS),
  });

export const jobsQuery = (filters: { state?: RunState; batch_id?: number }) =>
  queryOptions({
    queryKey: ["jobs", filters],
    queryFn: async ({ signal }) =>
      (await body(api.GET("/api/v1/jobs", { params: { query: filters }, signal }))).items,
    refetchInterval: () => (isLive() ? false : 2 * POLL_MS),
    placeholderData: keepPreviousData,
  });

export const queueQuery = queryOptions({
  queryKey: ["queue"],
  queryFn: ({ signal }) => body(api.GET("/api/v1/jobs/status", { signal })),
  refetchInterval: 4 * POLL_MS,
});

export const batchesQuery = queryOptions({
  queryKey: ["batches"],
  queryFn: async ({ signal }) => (await body(api.GET("/api/v1/batches", { signal }))).items,
  refetchInterval: () => (isLive() ? false : 4 * POLL_MS),
});

export const batchQuery = (id: number) =>
  queryOptions({
    queryKey: ["batch", id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/batches/{batch_id}", { params: { path: { batch_id: id } }, signal })),
    refetchInterval: () => (isLive() ? false : 2 * POLL_MS),
  });

export const comparisonQuery = (runs: readonly number[], predictions: readonly number[]) =>
  queryOptions({
    queryKey: ["comparison", runs, predictions],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/comparisons", {
          params: { query: { run_ids: runs.join(","), prediction_ids: predictions.join(",") } },
          signal,
        }),
      ),
    enabled: runs.length > 0,
    placeholderData: keepPreviousData,
  });

export interface TrendQuestion {
  run_ids: string;
  prediction_ids?: string;
  name: string;
  against: DerivativeTrend["against"];
  degree: number;
}

export const trendQuery = (question: TrendQuestion) =>
  queryOptions({
    queryKey: ["trend", question],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/comparisons/trend", { params: { query: question }, signal })),
    placeholderData: keepPreviousData,
  });

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

export const searchesQuery = queryOptions({
  queryKey: ["searches"],
  queryFn: async ({ signal }) => (await body(api.GET("/api/v1/searches", { signal }))).items,
  refetchInterval: (query) =>
    query.state.data?.every((one) => isOver(one.state)) === false ? 2 * POLL_MS : false,
});

export const searchQuery = (id: number) =>
  queryOptions({
    queryKey: ["searches", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/searches/{search_id}", { params: { path: { search_id: id } }, signal }),
      ),
    refetchInterval: (query) =>
      query.state.data !== undefined && isOver(query.state.data.state) ? false : POLL_MS,
  });

export const figureQuery = (kind: string, params: Record<string, QueryValue>) =>
  queryOptions({
    queryKey: ["figure", kind, params],
    queryFn: ({ signal }) =>
      json(address(`figures/${kind}`, params), { signal }) as Promise<FigureSpec>,
    placeholderData: keepPreviousData,
    staleTime: 60_000,
  });

export const designsQuery = queryOptions({
  queryKey: ["designs"],
  queryFn: async ({ signal }) => (await body(api.GET("/api/v1/designs", { signal }))).items,
});

export const designQuery = (id: number) =>
  queryOptions({
    queryKey: ["designs", id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/designs/{design_id}", { params: { path: { design_id: id } }, signal })),
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

export const taskQuery = (task: Task) =>
  queryOptions({
    queryKey: ["task", task.id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/tasks/{task_id}", { params: { path: { task_id: task.id } }, signal })),
    initialData: task,
    refetchInterval: (query) =>
      query.state.data?.state === "waiting" || query.state.data?.state === "running" ? 300 : false,
  });

export const controllersQuery = queryOptions({
  queryKey: ["controllers"],
  queryFn: async ({ signal }) => (await body(api.GET("/api/v1/controllers", { signal }))).items,
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

export const closedLoopQuery = (question: FlutterQuestion, controllerId: number | undefined) =>
  queryOptions({
    queryKey: ["closed-loop", question, controllerId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/closed-loop", {
          params: { query: { ...question, controller_id: controllerId ?? 0 } },
          signal,
        }),
      ),
    enabled: question.run_ids !== "" && controllerId !== undefined,
    placeholderData: keepPreviousData,
    staleTime: 60_000,
  });

export const rehearsalsQuery = (designId: number) =>
  queryOptions({
    queryKey: ["designs", designId, "rehearsals"],
    queryFn: async ({ signal }) =>
      (
        await body(
          api.GET("/api/v1/designs/{design_id}/rehearsals", {
            params: { path: { design_id: designId } },
            signal,
          }),
        )
      ).items,
    refetchInterval: (query) =>
      query.state.data?.some((one) => !isOver(one.state)) === true ? 3 * POLL_MS : false,
  });

export interface AllocationLimits {
  /** Largest deflection [rad] and load factor [g]; the design's own where undefined. */
  deflection?: number;
  load_factor?: number;
}

export const allocationQuery = (
  id: number,
  level: number,
  runId: number | undefined,
  limits: AllocationLimits,
) =>
  queryOptions({
    queryKey: ["designs", id, "allocation", level, runId, limits],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/designs/{design_id}/allocation", {
          params: { path: { design_id: id }, query: { run_id: runId ?? 0, level, ...limits } },
          signal,
        }),
      ),
    enabled: runId !== undefined,
    staleTime: 60_000,
  });

export const catalogueQuery = queryOptions({
  queryKey: ["designs", "catalogue"],
  queryFn: async ({ signal }) =>
    (await body(api.GET("/api/v1/designs/catalogue", { signal }))).items,
  staleTime: Infinity,
});

export const uploadQuery = (id: string) =>
  queryOptions({
    queryKey: ["upload", id],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/uploads/{upload_id}", { params: { path: { upload_id: id } }, signal })),
    staleTime: Infinity,
  });

export const uploadStateQuery = (id: string) =>
  queryOptions({
    queryKey: ["upload", id, "state"],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/uploads/{upload_id}/state", {
          params: { path: { upload_id: id } },
          signal,
        }),
      ),
    refetchInterval: (query) => (query.state.data?.state === "importing" ? 300 : false),
  });

export const mappingCheckQuery = (id: string, mapping: string) =>
  queryOptions({
    queryKey: ["upload", id, "check", mapping],
    queryFn: ({ signal }) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/check", {
          params: { path: { upload_id: id } },
          body: { mapping },
          signal,
        }),
      ),
    placeholderData: keepPreviousData,
    staleTime: Infinity,
    enabled: mapping !== "",
  });

export const mappingPreviewQuery = (id: string, mapping: string, channels: string[]) =>
  queryOptions({
    queryKey: ["upload", id, "preview", mapping, channels],
    queryFn: ({ signal }) =>
      json(`/api/v1/uploads/${id}/preview`, {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify({ mapping, channels }),
        signal,
      }) as Promise<FigureSpec>,
    placeholderData: keepPreviousData,
    staleTime: Infinity,
  });

export const mappingsQuery = queryOptions({
  queryKey: ["mappings"],
  queryFn: async ({ signal }) => (await body(api.GET("/api/v1/mappings", { signal }))).items,
});

export const structuresQuery = (aircraftId?: number) =>
  queryOptions({
    queryKey: ["structures", "list", aircraftId],
    queryFn: async ({ signal }) =>
      (
        await body(
          api.GET("/api/v1/model-structures", {
            params: { query: { aircraft_id: aircraftId } },
            signal,
          }),
        )
      ).items,
  });

/** The newest version; colleagues may save another at any time. */
export const structureQuery = (id: number) =>
  queryOptions({
    queryKey: ["structures", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/model-structures/{structure_id}", {
          params: { path: { structure_id: id } },
          signal,
        }),
      ),
  });

export const structureVersionsQuery = (id: number) =>
  queryOptions({
    queryKey: ["structures", id, "versions"],
    queryFn: async ({ signal }) =>
      (
        await body(
          api.GET("/api/v1/model-structures/{structure_id}/versions", {
            params: { path: { structure_id: id } },
            signal,
          }),
        )
      ).items,
  });

const table = (id: number) => ({ modal_table_id: id });

export const modesAtQuery = (id: number, fuel: number) =>
  queryOptions({
    queryKey: ["modal-table", id, "modes", fuel],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/modal-tables/{modal_table_id}/modes", {
          params: { path: table(id), query: { fuel } },
          signal,
        }),
      ),
    placeholderData: keepPreviousData,
  });

export const shapeQuery = (id: number, number: number, fuel: number) =>
  queryOptions({
    queryKey: ["modal-table", id, "shape", number, fuel],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/modal-tables/{modal_table_id}/shape", {
          params: { path: table(id), query: { number, fuel } },
          signal,
        }),
      ),
    placeholderData: keepPreviousData,
    staleTime: 60_000,
  });

export const correlationQuery = (
  id: number,
  query: { other_id: number; fuel: number; other_fuel: number },
) =>
  queryOptions({
    queryKey: ["modal-table", id, "correlation", query],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/modal-tables/{modal_table_id}/correlation", {
          params: { path: table(id), query },
          signal,
        }),
      ),
    retry: false,
  });

export const observabilityQuery = (
  id: number,
  query: { fuel: number; symmetry: "symmetric" | "antisymmetric" | "all"; up_to_hz: number },
) =>
  queryOptions({
    queryKey: ["modal-table", id, "observability", query],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/modal-tables/{modal_table_id}/observability", {
          params: { path: table(id), query },
          signal,
        }),
      ),
    placeholderData: keepPreviousData,
    retry: false,
  });

export const modelOrderQuery = (query: {
  aircraft_id: number;
  modal_table_id?: number;
  airspeed_m_s: number;
  altitude_m: number;
  fuel: number;
  high_hz: number;
}) =>
  queryOptions({
    queryKey: ["model-order", query],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/modal-tables/order", { params: { query }, signal })),
    placeholderData: keepPreviousData,
    retry: false,
  });

export const structureUploadQuery = (id: string) =>
  queryOptions({
    queryKey: ["upload", id, "structure"],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/uploads/{upload_id}/structure", {
          params: { path: { upload_id: id } },
          signal,
        }),
      ),
    retry: false,
  });

export const flutterSummariesQuery = (aircraftId: number) =>
  queryOptions({
    queryKey: ["flutter-summaries", aircraftId],
    queryFn: async ({ signal }) =>
      (
        await body(
          api.GET("/api/v1/flutter-summaries", {
            params: { query: { aircraft_id: aircraftId } },
            signal,
          }),
        )
      ).items,
  });

export const measuredResponsesQuery = (aircraftId: number) =>
  queryOptions({
    queryKey: ["measured-responses", aircraftId],
    queryFn: async ({ signal }) =>
      (
        await body(
          api.GET("/api/v1/measured-responses", {
            params: { query: { aircraft_id: aircraftId } },
            signal,
          }),
        )
      ).items,
  });

export const foundModesQuery = (
  id: number,
  query: { low_hz?: number; high_hz?: number; order: number },
) =>
  queryOptions({
    queryKey: ["measured-responses", "modes", id, query],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/measured-responses/{responses_id}/modes", {
          params: { path: { responses_id: id }, query },
          signal,
        }),
      ),
    placeholderData: keepPreviousData,
    retry: false,
  });

/** Modal tables, and what shows and orders their modes. */
import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";

export const modalTablesQuery = (aircraftId: number) =>
  queryOptions({
    queryKey: ["modal-tables", aircraftId],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/modal-tables", {
          params: { query: { aircraft_id: aircraftId } },
          signal,
        }),
      ),
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

export const flutterSummariesQuery = (aircraftId: number) =>
  queryOptions({
    queryKey: ["flutter-summaries", aircraftId],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/flutter-summaries", {
          params: { query: { aircraft_id: aircraftId } },
          signal,
        }),
      ),
  });

export interface SummaryRootsParams {
  analysis: number;
  g: number;
  modal_table_id?: number;
  fuel: number;
}

export const summaryRootsQuery = (id: number, query: SummaryRootsParams) =>
  queryOptions({
    queryKey: ["flutter-summaries", id, "roots", query],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/flutter-summaries/{summary_id}/roots", {
          params: { path: { summary_id: id }, query },
          signal,
        }),
      ),
    placeholderData: keepPreviousData,
    retry: false,
  });

export const writeBacksQuery = (aircraftId: number) =>
  queryOptions({
    queryKey: ["write-backs", aircraftId],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/write-backs", { params: { query: { aircraft_id: aircraftId } }, signal }),
      ),
  });

/** What a write-back of a run would write. */
export const writeBackProposalQuery = (runId: number) =>
  queryOptions({
    queryKey: ["write-backs", "of run", runId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/write-backs/proposal", { params: { query: { run_id: runId } }, signal }),
      ),
    retry: false,
  });

/** Commands that import and correct modal data. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body } from "../client";
import type {
  EstimatedResponsesRequest,
  MassRequest,
  ModalDataRequest,
  OrthogonalityRequest,
  ResponsesRequest,
} from "../types";

export function useCorrectMode(tableId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: { number: number; name: string; symmetric: boolean; reason: string }) =>
      body(
        api.POST("/api/v1/modal-tables/{modal_table_id}/corrections", {
          params: { path: { modal_table_id: tableId } },
          body: request,
        }),
      ),
    onSuccess: () => cache.invalidateQueries(),
  });
}

export function useImportStructure(upload: string, aircraftId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: Pick<ModalDataRequest, "name" | "kind"> & Partial<ModalDataRequest>) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/modal-data", {
          params: { path: { upload_id: upload } },
          body: {
            axes: "aft right up",
            origin: [0, 0, 0],
            rigid_modes: false,
            ...request,
            aircraft_id: aircraftId,
          },
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["modal-tables"] }),
  });
}

export function useImportMassProperties(upload: string, aircraftId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: Pick<MassRequest, "length_unit" | "mass_unit" | "axes" | "fuel">) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/mass-properties", {
          params: { path: { upload_id: upload } },
          body: { origin: [0, 0, 0], ...request, aircraft_id: aircraftId },
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["aircraft"] }),
  });
}

export function useOrthogonality(upload: string) {
  return useMutation({
    mutationFn: (request: OrthogonalityRequest) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/orthogonality", {
          params: { path: { upload_id: upload } },
          body: request,
        }),
      ),
  });
}

export function useImportFlutterSummary(upload: string, aircraftId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: { name: string; speed_unit: "m/s" | "ft/s" | "in/s" | "kt" | "km/h" }) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/flutter-summary", {
          params: { path: { upload_id: upload } },
          body: { ...request, aircraft_id: aircraftId },
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["flutter-summaries"] }),
  });
}

export function useImportResponses(upload: string, aircraftId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: Pick<ResponsesRequest, "name"> & Partial<ResponsesRequest>) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/responses", {
          params: { path: { upload_id: upload } },
          body: {
            fuel: 0,
            axes: "aft right up",
            origin: [0, 0, 0],
            ...request,
            aircraft_id: aircraftId,
          },
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["measured-responses"] }),
  });
}

export function useEstimateResponses(upload: string, aircraftId: number) {
  return useMutation({
    mutationFn: (
      request: Pick<
        EstimatedResponsesRequest,
        "name" | "averages" | "estimator" | "overlap" | "window"
      > &
        Partial<EstimatedResponsesRequest>,
    ) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/response-estimates", {
          params: { path: { upload_id: upload } },
          body: {
            fuel: 0,
            axes: "aft right up",
            origin: [0, 0, 0],
            ...request,
            aircraft_id: aircraftId,
          },
        }),
      ),
  });
}

export function useSaveFoundModes(responsesId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: {
      name: string;
      low_hz?: number;
      high_hz?: number;
      order: number;
      poles: number[];
      selected: number[];
      template_id: number | null;
    }) =>
      body(
        api.POST("/api/v1/measured-responses/{responses_id}/modes", {
          params: { path: { responses_id: responsesId } },
          body: request,
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["modal-tables"] }),
  });
}

export function useUpdateModalTable(modalTableId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: { name: string; test_ids: number[] }) =>
      body(
        api.POST("/api/v1/modal-tables/{modal_table_id}/updates", {
          params: { path: { modal_table_id: modalTableId } },
          body: { run_ids: [], ...request },
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["modal-tables"] }),
  });
}

/** Queries to refresh after a write-back or its undo: other versions are the default then. */
function useRefreshVersions() {
  const cache = useQueryClient();
  return () =>
    Promise.all(
      [["write-backs"], ["modal-tables"], ["predictions"], ["maneuver"]].map((queryKey) =>
        cache.invalidateQueries({ queryKey }),
      ),
    );
}

export function useWriteBack(runId: number) {
  return useMutation({
    mutationFn: (reason: string) =>
      body(api.POST("/api/v1/write-backs", { body: { run_id: runId, reason } })),
    onSuccess: useRefreshVersions(),
  });
}

export function useUndoWriteBack() {
  return useMutation({
    mutationFn: (id: number) =>
      body(
        api.DELETE("/api/v1/write-backs/{write_back_id}", {
          params: { path: { write_back_id: id } },
        }),
      ),
    onSuccess: useRefreshVersions(),
  });
}

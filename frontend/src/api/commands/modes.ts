/** Takes in modes of structural models and vibration tests, and corrects them. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body } from "../client";
import type { ResponsesRequest, StructureFilesRequest } from "../types";

export function useCorrectMode(tableId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: { number: number; name: string; symmetric: boolean; reason: string }) =>
      body(
        api.POST("/api/v1/modal-tables/{modal_table_id}/corrections", {
          params: { path: { modal_table_id: tableId } },
          body: wanted,
        }),
      ),
    onSuccess: () => cache.invalidateQueries(),
  });
}

export function useImportStructure(upload: string, aircraftId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (
      wanted: Pick<StructureFilesRequest, "name" | "kind"> & Partial<StructureFilesRequest>,
    ) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/structure", {
          params: { path: { upload_id: upload } },
          body: {
            axes: "aft right up",
            origin: [0, 0, 0],
            rigid_modes: false,
            ...wanted,
            aircraft_id: aircraftId,
          },
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["modal-tables"] }),
  });
}

export function useImportFlutterSummary(upload: string, aircraftId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: { name: string; speed_unit: "m/s" | "ft/s" | "in/s" | "kt" | "km/h" }) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/flutter-summary", {
          params: { path: { upload_id: upload } },
          body: { ...wanted, aircraft_id: aircraftId },
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["flutter-summaries"] }),
  });
}

export function useImportResponses(upload: string, aircraftId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (
      wanted: Pick<ResponsesRequest, "name" | "response_unit" | "force_unit"> &
        Partial<ResponsesRequest>,
    ) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/responses", {
          params: { path: { upload_id: upload } },
          body: {
            fuel: 0,
            axes: "aft right up",
            origin: [0, 0, 0],
            ...wanted,
            aircraft_id: aircraftId,
          },
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["measured-responses"] }),
  });
}

export function useKeepFoundModes(responsesId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: {
      name: string;
      low_hz?: number;
      high_hz?: number;
      order: number;
      keep: number[];
      like_id: number | null;
    }) =>
      body(
        api.POST("/api/v1/measured-responses/{responses_id}/modes", {
          params: { path: { responses_id: responsesId } },
          body: wanted,
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["modal-tables"] }),
  });
}

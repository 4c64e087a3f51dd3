/** Commands on the aircraft: definition, thrust table and controllers. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { named } from "../analyst";
import { api, body, json } from "../client";
import type { GlobalModelParams } from "../queries/globalModel";
import type {
  Controller,
  ComputePredictionRequest,
  GlobalModelVersionRequest,
  SaveGlobalPredictionRequest,
  ThrustRequest,
} from "../types";

/** Adds an aircraft before its first flight, from the text of its definition. */
export function useAddAircraft() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (text: string) => body(api.POST("/api/v1/aircraft", { body: { text } })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["aircraft"] }),
  });
}

export function useSetThrust() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: ({ id, table }: { id: number; table: ThrustRequest }) =>
      body(
        api.PUT("/api/v1/aircraft/{aircraft_id}/thrust", {
          params: { path: { aircraft_id: id } },
          body: table,
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["aircraft"] }),
  });
}

export function useRemoveThrust() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (id: number) =>
      body(
        api.DELETE("/api/v1/aircraft/{aircraft_id}/thrust", {
          params: { path: { aircraft_id: id } },
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["aircraft"] }),
  });
}

interface GivenController {
  aircraft: number;
  name: string;
  text: string;
  file: File | null;
  reads: string;
  drives: string;
}

export function useSaveController() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: ({ aircraft, name, text, file, reads, drives }: GivenController) => {
      if (file === null) {
        return body(
          api.POST("/api/v1/controllers", { body: { aircraft_id: aircraft, name, text } }),
        );
      }
      const form = new FormData();
      form.append("file", file);
      form.append("aircraft_id", String(aircraft));
      form.append("name", name);
      form.append("reads", reads);
      form.append("drives", drives);
      return json("/api/v1/controllers/files", {
        method: "POST",
        body: form,
      }) as Promise<Controller>;
    },
    onSuccess: () => cache.invalidateQueries({ queryKey: ["controllers"] }),
  });
}

/** Requests a prediction from a planform; its job ends when it is stored. */
export function useComputePrediction() {
  return useMutation({
    mutationFn: (request: ComputePredictionRequest) =>
      body(api.POST("/api/v1/predictions", { body: request })),
  });
}

/** Stores a computed global model as the next version. */
export function useSaveGlobalModelVersion() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: ({
      query,
      request,
    }: {
      query: GlobalModelParams;
      request: GlobalModelVersionRequest;
    }) =>
      body(
        api.POST("/api/v1/global-models/versions", {
          params: { query, header: named() },
          body: request,
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["global-models", "versions"] }),
  });
}

/** Stores a computed global model at one condition as a prediction. */
export function useSaveGlobalPrediction() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: ({
      query,
      request,
    }: {
      query: GlobalModelParams;
      request: SaveGlobalPredictionRequest;
    }) => body(api.POST("/api/v1/global-models/predictions", { params: { query }, body: request })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["predictions"] }),
  });
}

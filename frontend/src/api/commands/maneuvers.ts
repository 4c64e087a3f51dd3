/** Cuts maneuvers, corrects their channels and judges them. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body } from "../client";
import type { CutRequest, GreyBoxRequest, StepRequest } from "../types";

/** Cuts maneuvers out of a flight, one after the other; what was cut stays when one is refused. */
export function useCut(flightId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: async (request: CutRequest[]) => {
      const made = [];
      for (const one of request) {
        made.push(
          await body(
            api.POST("/api/v1/flights/{flight_id}/maneuvers", {
              params: { path: { flight_id: flightId } },
              body: one,
            }),
          ),
        );
      }
      return made;
    },
    onSettled: () =>
      Promise.all(
        [["flight", flightId, "found"], ["maneuvers"], ["quality"], ["figure", "envelope"]].map(
          (queryKey) => cache.invalidateQueries({ queryKey }),
        ),
      ),
  });
}

/** Queries to refresh after a correction of channels. */
function useRefreshManeuver(id: number) {
  const cache = useQueryClient();
  return () =>
    Promise.all(
      [["conditioning", id], ["quality"], ["figure"], ["result job"]].map((queryKey) =>
        cache.invalidateQueries({ queryKey }),
      ),
    );
}

export function useTakeCorrections(id: number) {
  return useMutation({
    mutationFn: (items: StepRequest[]) =>
      body(
        api.POST("/api/v1/maneuvers/{maneuver_id}/conditioning", {
          params: { path: { maneuver_id: id } },
          body: { items },
        }),
      ),
    onSuccess: useRefreshManeuver(id),
  });
}

export function useUndoCorrection(id: number) {
  return useMutation({
    mutationFn: (step: number) =>
      body(
        api.DELETE("/api/v1/maneuvers/{maneuver_id}/conditioning/{step_id}", {
          params: { path: { maneuver_id: id, step_id: step } },
        }),
      ),
    onSuccess: useRefreshManeuver(id),
  });
}

export function useAssessManeuver(id: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: () => body(api.POST("/api/v1/quality/assess", { body: { maneuver_ids: [id] } })),
    onSettled: () => cache.invalidateQueries({ queryKey: ["quality"] }),
  });
}

export function useAssess() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: "begin" | "stop") =>
      request === "begin"
        ? body(api.POST("/api/v1/quality/assess", { body: {} }))
        : body(api.DELETE("/api/v1/quality/assess")),
    onSettled: () => cache.invalidateQueries({ queryKey: ["quality"] }),
  });
}

/** Fits a grey-box model to a maneuver; the job of an equal request is the same. */
export function useFitGreyBox() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: GreyBoxRequest) =>
      body(api.POST("/api/v1/grey-box-fits", { body: request })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["grey-box-fits"] }),
  });
}

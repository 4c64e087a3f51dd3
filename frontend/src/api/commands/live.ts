/** Commands on streams, their alarms and test points. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { named } from "../analyst";
import { api, body } from "../client";
import type { LiveAlarm, LiveTestPoint, StreamRequest } from "../types";

export function useStartStream() {
  const refresh = useRefreshStreams();
  return useMutation({
    mutationFn: (request: StreamRequest) =>
      body(api.POST("/api/v1/live/streams", { body: request })),
    onSettled: refresh,
  });
}

export function useStopStream(id: number) {
  const refresh = useRefreshStreams();
  return useMutation({
    mutationFn: () =>
      body(
        api.POST("/api/v1/live/streams/{stream_id}/stop", { params: { path: { stream_id: id } } }),
      ),
    onSettled: refresh,
  });
}

export function useAcknowledgeAlarm(id: number) {
  const refresh = useRefreshStreams();
  return useMutation({
    mutationFn: ({ kind, subject, time_s }: LiveAlarm) =>
      body(
        api.POST("/api/v1/live/streams/{stream_id}/acknowledgements", {
          params: { path: { stream_id: id }, header: named() },
          body: { kind, subject, time_s, note: "" },
        }),
      ),
    onSettled: refresh,
  });
}

/** Accepts a test point, or marks it to be repeated. */
export function useDecideTestPoint() {
  const refresh = useRefreshStreams();
  return useMutation({
    mutationFn: ({ id, status }: { id: number; status: LiveTestPoint["status"] }) =>
      body(
        api.PUT("/api/v1/live/test-points/{point_id}", {
          params: { path: { point_id: id }, header: named() },
          body: { status, message: "" },
        }),
      ),
    onSettled: refresh,
  });
}

function useRefreshStreams() {
  const cache = useQueryClient();
  return () =>
    Promise.all([["streams"], ["stream"]].map((queryKey) => cache.invalidateQueries({ queryKey })));
}

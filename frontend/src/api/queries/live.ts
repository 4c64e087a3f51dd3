/** Streams of samples while an aircraft flies. */
import { queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";

export const receiversQuery = queryOptions({
  queryKey: ["receivers"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/live/receivers", { signal })),
  staleTime: 60_000,
});

export const streamsQuery = queryOptions({
  queryKey: ["streams"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/live/streams", { signal })),
});

export const streamQuery = (id: number) =>
  queryOptions({
    queryKey: ["stream", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/live/streams/{stream_id}", {
          params: { path: { stream_id: id } },
          signal,
        }),
      ),
  });

/** What was known at each second of the maneuver that began at this time [s]. */
export const streamHistoryQuery = (id: number, since_s: number | undefined) =>
  queryOptions({
    queryKey: ["stream", id, "history", since_s],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/live/streams/{stream_id}/history", {
          params: { path: { stream_id: id }, query: { since_s } },
          signal,
        }),
      ),
  });

/** Strip charts of a running stream from a time on [s]. */
export const readStreamSamples = (id: number, channels: string, since_s: number) =>
  body(
    api.GET("/api/v1/live/streams/{stream_id}/samples", {
      params: { path: { stream_id: id }, query: { channels, since_s, columns: MOST_COLUMNS } },
    }),
  );

/** More than a strip chart has, so that the server joins none. */
const MOST_COLUMNS = 2000;

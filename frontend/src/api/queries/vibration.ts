/** Measured responses of a vibration test, and the modes in them. */
import { queryOptions } from "@tanstack/react-query";
import type { FoundModes } from "../types";
import { api, body, items } from "../client";
import type { StoredResultOptions } from "../useStoredResult";

export const measuredResponsesQuery = (aircraftId: number) =>
  queryOptions({
    queryKey: ["measured-responses", aircraftId],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/measured-responses", {
          params: { query: { aircraft_id: aircraftId } },
          signal,
        }),
      ),
  });

/** The modes of a band; an equal request is the same job. */
export const foundModesResult = (
  id: number,
  query: { low_hz?: number; high_hz?: number; order: number; poles?: string },
): StoredResultOptions<FoundModes> => {
  const params = { path: { responses_id: id }, query };
  const path = "/api/v1/measured-responses/{responses_id}/modes/results";
  return {
    key: ["measured-responses", "modes", id, query],
    enabled: true,
    read: (signal) =>
      body(api.GET("/api/v1/measured-responses/{responses_id}/modes", { params, signal })),
    find: (signal) => body(api.GET(path, { params, signal })),
    submit: () => body(api.POST(path, { params })),
  };
};

export const orthogonalityQuery = (jobId: number) =>
  queryOptions({
    queryKey: ["orthogonality", jobId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/orthogonality/{job_id}", { params: { path: { job_id: jobId } }, signal }),
      ),
    staleTime: Infinity,
  });

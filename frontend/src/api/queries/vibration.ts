/** Measured responses of a vibration test, and the modes in them. */
import { queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";
import { storedResult } from "../storedResult";

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
) =>
  storedResult("/api/v1/measured-responses/{responses_id}/modes", {
    path: { responses_id: id },
    query,
  });

export const orthogonalityQuery = (jobId: number) =>
  queryOptions({
    queryKey: ["orthogonality", jobId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/orthogonality/{job_id}", { params: { path: { job_id: jobId } }, signal }),
      ),
    staleTime: Infinity,
  });

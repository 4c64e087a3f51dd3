/** Measured responses of a vibration test, and the modes in them. */
import { queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";

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

export const orthogonalityQuery = (jobId: number) =>
  queryOptions({
    queryKey: ["orthogonality", jobId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/orthogonality/{job_id}", { params: { path: { job_id: jobId } }, signal }),
      ),
    staleTime: Infinity,
  });

/** What pages read of maneuvers: the list, one of them, and how its channels were corrected. */
import { infiniteQueryOptions, keepPreviousData, queryOptions } from "@tanstack/react-query";
import { address, api, body, items, json } from "../client";
import type { FigureSpec, ManeuverFilters, ModelAxis } from "../types";
import { storedResult } from "../storedResult";
import { PAGED } from "./habits";

export const maneuversQuery = (filters: ManeuverFilters, sort: string, limit = 50) =>
  infiniteQueryOptions({
    queryKey: ["maneuvers", filters, sort, limit],
    queryFn: ({ pageParam, signal }) =>
      body(
        api.GET("/api/v1/maneuvers", {
          params: { query: { ...filters, sort, limit, after: pageParam } },
          signal,
        }),
      ),
    ...PAGED,
  });

export const maneuverFacetsQuery = (filters: ManeuverFilters) =>
  queryOptions({
    queryKey: ["maneuvers", "facets", filters],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/maneuvers/facets", { params: { query: filters }, signal })),
    placeholderData: keepPreviousData,
  });

export const maneuverQuery = (id: number) =>
  queryOptions({
    queryKey: ["maneuver", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/maneuvers/{maneuver_id}", {
          params: { path: { maneuver_id: id } },
          signal,
        }),
      ),
  });

/** The reconstructed motion, of which figures draw quantities; an equal request is the same job. */
export const reconstructionResult = (
  id: number,
  modes: number[] | undefined,
  axis: ModelAxis | undefined,
) =>
  storedResult(
    "/api/v1/maneuvers/{maneuver_id}/reconstruction",
    { path: { maneuver_id: id }, query: { modes: modes?.join(","), axis } },
    true,
    (signal) =>
      json(address("figures/reconstruction", { maneuver_id: id, modes, axis }), {
        signal,
      }) as Promise<FigureSpec>,
  );

/** Installed grey-box models, and whether files are accepted. */
export const greyBoxModelsQuery = queryOptions({
  queryKey: ["grey-box-models"],
  queryFn: ({ signal }) => body(api.GET("/api/v1/grey-box-models", { signal })),
  staleTime: Infinity,
});

/** The fits of grey-box models to a maneuver, newest first. */
export const greyBoxFitsQuery = (id: number) =>
  queryOptions({
    queryKey: ["grey-box-fits", id],
    queryFn: ({ signal }) =>
      items(api.GET("/api/v1/grey-box-fits", { params: { query: { maneuver_id: id } }, signal })),
  });

/** The fit of a grey-box model that a job has computed. */
export const greyBoxFitQuery = (jobId: number) =>
  queryOptions({
    queryKey: ["grey-box-fit", jobId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/grey-box-fits/{job_id}", { params: { path: { job_id: jobId } }, signal }),
      ),
    staleTime: Infinity,
  });

export const conditioningQuery = (id: number) =>
  queryOptions({
    queryKey: ["conditioning", id],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/maneuvers/{maneuver_id}/conditioning", {
          params: { path: { maneuver_id: id } },
          signal,
        }),
      ),
  });

/** Modes and band that suit a maneuver, and what they ask of its data. */
export const runProposalQuery = (
  id: number,
  band: [number, number] | undefined,
  axis?: ModelAxis,
) =>
  queryOptions({
    queryKey: ["maneuver", id, "run-proposal", band, axis],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/maneuvers/{maneuver_id}/run-proposal", {
          params: {
            path: { maneuver_id: id },
            query: { low_hz: band?.[0], high_hz: band?.[1], axis },
          },
          signal,
        }),
      ),
  });

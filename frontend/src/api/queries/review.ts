/** What pages read of the review of model structures. */
import { queryOptions } from "@tanstack/react-query";
import { named } from "../analyst";
import { api, body, items } from "../client";
import type { DecisionState } from "../types";

interface DecisionFilters {
  aircraft_id?: number;
  state?: DecisionState;
}

export const decisionsQuery = (filters: DecisionFilters) =>
  queryOptions({
    queryKey: ["decisions", "list", filters],
    queryFn: ({ signal }) =>
      items(api.GET("/api/v1/decisions", { params: { query: filters }, signal })),
  });

export const decisionQuery = (id: number) =>
  queryOptions({
    queryKey: ["decisions", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/decisions/{decision_id}", {
          params: { path: { decision_id: id } },
          signal,
        }),
      ),
  });

/** What a vote on a revision can rest on; runs may be corrected and flutter computed meanwhile. */
export const voteEvidenceQuery = (id: number, revision: number) =>
  queryOptions({
    queryKey: ["decisions", id, "evidence", revision],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/decisions/{decision_id}/evidence", {
          params: { path: { decision_id: id } },
          signal,
        }),
      ),
  });

/** The evidence that a proposal with these runs would have. */
export const proposalEvidenceQuery = (
  structure: { id: number; version: number } | null,
  runs: readonly number[],
) =>
  queryOptions({
    queryKey: ["decisions", "proposal-evidence", structure, runs],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/proposal-evidence", {
          params: {
            query: {
              structure_id: structure?.id ?? 0,
              structure_version: structure?.version,
              run_ids: runs.join(","),
            },
          },
          signal,
        }),
      ),
    enabled: structure !== null && runs.length > 0,
  });

export const reviewRulesQuery = (aircraftId: number) =>
  queryOptions({
    queryKey: ["review-rules", aircraftId],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/review-rules/{aircraft_id}", {
          params: { path: { aircraft_id: aircraftId } },
          signal,
        }),
      ),
  });

export const baselinesQuery = (aircraftId: number) =>
  queryOptions({
    queryKey: ["decisions", "baselines", aircraftId],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/baselines", { params: { query: { aircraft_id: aircraftId } }, signal }),
      ),
  });

/** The approved structure of each maneuver's condition. */
export const maneuverBaselinesQuery = (ids: readonly number[]) =>
  queryOptions({
    queryKey: ["decisions", "maneuver-baselines", ids],
    queryFn: ({ signal }) =>
      items(
        api.GET("/api/v1/maneuver-baselines", {
          params: { query: { maneuver_ids: ids.join(",") } },
          signal,
        }),
      ),
  });

export const notificationsQuery = (name: string) =>
  queryOptions({
    queryKey: ["notifications", name],
    queryFn: ({ signal }) =>
      body(api.GET("/api/v1/notifications", { params: { header: named() }, signal })),
    enabled: name !== "",
    retry: false,
  });

/** Kind, title, hash and author of what was frozen as evidence; it never changes. */
export const frozenFigureQuery = (id: number) =>
  queryOptions({
    queryKey: ["frozen-figures", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/frozen-figures/{figure_id}", {
          params: { path: { figure_id: id } },
          signal,
        }),
      ),
    staleTime: Infinity,
  });

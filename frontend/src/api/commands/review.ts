/** What pages change in the review of model structures. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { named } from "../analyst";
import { api, body } from "../client";
import type { FreezeRequest, ProposalRequest, RulesRequest, Vote } from "../types";

/** Queries that show a decision. */
function useRefreshDecisions() {
  const cache = useQueryClient();
  return () =>
    Promise.all(
      [["decisions"], ["notifications"], ["review-rules"], ["global-models"]].map((queryKey) =>
        cache.invalidateQueries({ queryKey }),
      ),
    );
}

export function usePropose() {
  return useMutation({
    mutationFn: (proposal: ProposalRequest) =>
      body(api.POST("/api/v1/decisions", { params: { header: named() }, body: proposal })),
    onSuccess: useRefreshDecisions(),
  });
}

export function useReviseDecision(id: number) {
  return useMutation({
    mutationFn: (request: { revision: number; proposal: ProposalRequest }) =>
      body(
        api.POST("/api/v1/decisions/{decision_id}/revisions", {
          params: { path: { decision_id: id }, header: named() },
          body: request,
        }),
      ),
    onSettled: useRefreshDecisions(),
  });
}

export function useCommentDecision(id: number) {
  return useMutation({
    mutationFn: (request: { text: string; derivative?: string }) =>
      body(
        api.POST("/api/v1/decisions/{decision_id}/comments", {
          params: { path: { decision_id: id }, header: named() },
          body: request,
        }),
      ),
    onSuccess: useRefreshDecisions(),
  });
}

export function useVote(id: number) {
  return useMutation({
    mutationFn: (request: { revision: number; vote: Vote; text: string; despite: string }) =>
      body(
        api.POST("/api/v1/decisions/{decision_id}/votes", {
          params: { path: { decision_id: id }, header: named() },
          body: request,
        }),
      ),
    onSettled: useRefreshDecisions(),
  });
}

export function useWithdrawDecision(id: number) {
  return useMutation({
    mutationFn: (request: { revision: number; text: string }) =>
      body(
        api.POST("/api/v1/decisions/{decision_id}/withdrawal", {
          params: { path: { decision_id: id }, header: named() },
          body: request,
        }),
      ),
    onSettled: useRefreshDecisions(),
  });
}

export function useChangeRules(aircraftId: number) {
  return useMutation({
    mutationFn: (request: RulesRequest) =>
      body(
        api.PUT("/api/v1/review-rules/{aircraft_id}", {
          params: { path: { aircraft_id: aircraftId }, header: named() },
          body: request,
        }),
      ),
    onSettled: useRefreshDecisions(),
  });
}

export const freezeFigure = (request: FreezeRequest) =>
  body(api.POST("/api/v1/frozen-figures", { params: { header: named() }, body: request }));

/** Marks a decision as read; without an id, all. */
export function useMarkSeen() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (what?: { subject: "decision" | "structure"; id: number }) => {
      const header = named();
      if (what === undefined) {
        return body(api.POST("/api/v1/notifications/seen", { params: { header } }));
      }
      return what.subject === "decision"
        ? body(
            api.POST("/api/v1/decisions/{decision_id}/seen", {
              params: { path: { decision_id: what.id }, header },
            }),
          )
        : body(
            api.POST("/api/v1/model-structures/{structure_id}/seen", {
              params: { path: { structure_id: what.id }, header },
            }),
          );
    },
    onSuccess: () => cache.invalidateQueries({ queryKey: ["notifications"] }),
  });
}

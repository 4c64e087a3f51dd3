/** Log-in, log-out, passwords, sessions and API tokens. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body } from "../client";
import { storeUnits } from "../units";
import { sessionQuery } from "../queries";
import type { DisplayUnits, TokenRequest } from "../types";

export function useLogIn() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: { name: string; password: string }) =>
      body(api.POST("/api/v1/session", { body: request })),
    onSuccess: (session) => {
      cache.setQueryData(sessionQuery.queryKey, session);
    },
  });
}

/** Stores the display units with the account, or without one in this browser. */
export function useSetUnits() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: async (units: DisplayUnits) => {
      const session = await cache.query({ ...sessionQuery, staleTime: "static" });
      if (session.units == null) storeUnits(units);
      else await body(api.PUT("/api/v1/session/units", { body: units }));
    },
    onSuccess: () => cache.invalidateQueries({ queryKey: sessionQuery.queryKey }),
  });
}

export function useLogOut() {
  return useMutation({
    mutationFn: () => body(api.DELETE("/api/v1/session")),
    onSettled: leave,
  });
}

export function useEndAllSessions() {
  return useMutation({
    mutationFn: () => body(api.DELETE("/api/v1/sessions")),
    onSuccess: leave,
  });
}

/** Nothing of the account stays in the memory of the page. */
function leave() {
  window.location.assign("/");
}

export function useEndSession() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (id: number) =>
      body(api.DELETE("/api/v1/sessions/{session_id}", { params: { path: { session_id: id } } })),
    onSettled: () => cache.invalidateQueries({ queryKey: ["sessions"] }),
  });
}

export function useChangePassword() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: { password: string; new_password: string }) =>
      body(api.PUT("/api/v1/session/password", { body: request })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["sessions"] }),
  });
}

export function useAcceptInvitation() {
  return useMutation({
    mutationFn: (request: { code: string; password: string }) =>
      body(api.POST("/api/v1/invitations", { body: request })),
  });
}

export function useCreateToken() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: TokenRequest) => body(api.POST("/api/v1/tokens", { body: request })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["tokens"] }),
  });
}

export function useDeleteToken() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (id: number) =>
      body(api.DELETE("/api/v1/tokens/{token_id}", { params: { path: { token_id: id } } })),
    onSettled: () => cache.invalidateQueries({ queryKey: ["tokens"] }),
  });
}

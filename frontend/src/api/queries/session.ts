/** Who is logged in, and the sessions and tokens of the account. */
import { queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";

export const sessionQuery = queryOptions({
  queryKey: ["session"],
  queryFn: ({ signal }) => body(api.GET("/api/v1/session", { signal })),
  staleTime: 60_000,
});

export const sessionsQuery = queryOptions({
  queryKey: ["sessions"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/sessions", { signal })),
});

export const tokensQuery = queryOptions({
  queryKey: ["tokens"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/tokens", { signal })),
});

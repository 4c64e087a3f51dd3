/** Searches for a model structure. */
import { queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";
import { isOver } from "../types";
import { POLL_MS } from "./habits";

export const searchesQuery = queryOptions({
  queryKey: ["searches"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/searches", { signal })),
  refetchInterval: (query) =>
    query.state.data?.every((one) => isOver(one.state)) === false ? 2 * POLL_MS : false,
});

export const searchQuery = (id: number) =>
  queryOptions({
    queryKey: ["searches", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/searches/{search_id}", { params: { path: { search_id: id } }, signal }),
      ),
    refetchInterval: (query) =>
      query.state.data !== undefined && isOver(query.state.data.state) ? false : POLL_MS,
  });

/** Searches for a model structure. */
import { queryOptions } from "@tanstack/react-query";
import { api, body, items } from "../client";

export const searchesQuery = queryOptions({
  queryKey: ["searches"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/searches", { signal })),
});

export const searchQuery = (id: number) =>
  queryOptions({
    queryKey: ["searches", id],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/searches/{search_id}", { params: { path: { search_id: id } }, signal }),
      ),
  });

/** Uploaded files and how their channels are named. */
import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import { api, body, items, json } from "../client";
import type { FigureSpec } from "../types";

export const uploadQuery = (id: string, aircraft?: string) =>
  queryOptions({
    queryKey: aircraft === undefined ? ["upload", id] : ["upload", id, aircraft],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/uploads/{upload_id}", {
          params: { path: { upload_id: id }, query: { aircraft } },
          signal,
        }),
      ),
    staleTime: Infinity,
  });

/** Own uploads whose mapping was edited and that are not imported. */
export const draftsQuery = queryOptions({
  queryKey: ["uploads", "drafts"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/uploads", { signal })),
});

/** The newest job that imports an upload. */
export const importJobQuery = (id: string) =>
  queryOptions({
    queryKey: ["upload", id, "import"],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/uploads/{upload_id}/import", {
          params: { path: { upload_id: id } },
          signal,
        }),
      ),
  });

export const mappingCheckQuery = (id: string, mapping: string) =>
  queryOptions({
    queryKey: ["upload", id, "check", mapping],
    queryFn: ({ signal }) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/check", {
          params: { path: { upload_id: id } },
          body: { mapping, confirmed: false },
          signal,
        }),
      ),
    placeholderData: keepPreviousData,
    staleTime: Infinity,
    enabled: mapping !== "",
  });

export const mappingPreviewQuery = (id: string, mapping: string, channels: string[]) =>
  queryOptions({
    queryKey: ["upload", id, "preview", mapping, channels],
    queryFn: ({ signal }) =>
      json(`/api/v1/uploads/${id}/preview`, {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify({ mapping, channels }),
        signal,
      }) as Promise<FigureSpec>,
    placeholderData: keepPreviousData,
    staleTime: Infinity,
  });

export const mappingsQuery = queryOptions({
  queryKey: ["mappings"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/mappings", { signal })),
});

export const structureUploadQuery = (id: string) =>
  queryOptions({
    queryKey: ["upload", id, "structure"],
    queryFn: ({ signal }) =>
      body(
        api.GET("/api/v1/uploads/{upload_id}/modal-data", {
          params: { path: { upload_id: id } },
          signal,
        }),
      ),
    retry: false,
  });

/** Sends files and takes them in. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body, json } from "../client";
import { draftsQuery, importJobQuery, uploadQuery } from "../queries";
import type { UploadDetail } from "../types";

export function useUploadFiles() {
  return useMutation({
    mutationFn: (files: File[]) => {
      const form = new FormData();
      for (const file of files) form.append("files", file);
      return json("/api/v1/uploads", { method: "POST", body: form }) as Promise<UploadDetail>;
    },
  });
}

export function useSaveDraft() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: ({ id, mapping }: { id: string; mapping: string }) =>
      body(
        api.PUT("/api/v1/uploads/{upload_id}/draft", {
          params: { path: { upload_id: id } },
          body: { mapping },
        }),
      ),
    onSuccess: (_, { id, mapping }) => {
      cache.setQueryData(
        uploadQuery(id).queryKey,
        (found) => found && { ...found, draft: mapping },
      );
      void cache.invalidateQueries({ queryKey: draftsQuery.queryKey });
    },
  });
}

export function useDeleteUpload() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (id: string) =>
      body(api.DELETE("/api/v1/uploads/{upload_id}", { params: { path: { upload_id: id } } })),
    onSettled: () => cache.invalidateQueries({ queryKey: draftsQuery.queryKey }),
  });
}

export function useImportUpload(id: string) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (mapping: string) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/import", {
          params: { path: { upload_id: id } },
          body: { mapping, confirmed: false },
        }),
      ),
    onSuccess: async (job) => {
      const { queryKey } = importJobQuery(id);
      // A response that is under way shows no job yet, and would remain.
      await cache.cancelQueries({ queryKey });
      cache.setQueryData(queryKey, { job });
    },
  });
}

export function useSaveMapping() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: { name: string; text: string }) =>
      body(api.POST("/api/v1/mappings", { body: { ...request, note: "" } })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["mappings"] }),
  });
}

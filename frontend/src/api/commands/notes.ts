/** What pages change in notes. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { named } from "../analyst";
import { api, body } from "../client";
import type { NoteRequest } from "../types";

function useRefreshNotes() {
  const cache = useQueryClient();
  return () => cache.invalidateQueries({ queryKey: ["notes"] });
}

export function useAddNote() {
  return useMutation({
    mutationFn: (note: NoteRequest) =>
      body(api.POST("/api/v1/notes", { params: { header: named() }, body: note })),
    onSuccess: useRefreshNotes(),
  });
}

export function useEditNote(id: number) {
  return useMutation({
    mutationFn: (edit: { revision: number; text: string }) =>
      body(
        api.PUT("/api/v1/notes/{note_id}", {
          params: { path: { note_id: id }, header: named() },
          body: edit,
        }),
      ),
    onSettled: useRefreshNotes(),
  });
}

export function useDeleteNote(id: number) {
  return useMutation({
    mutationFn: (revision: number) =>
      body(
        api.DELETE("/api/v1/notes/{note_id}", {
          params: { path: { note_id: id }, header: named(), query: { revision } },
        }),
      ),
    onSettled: useRefreshNotes(),
  });
}

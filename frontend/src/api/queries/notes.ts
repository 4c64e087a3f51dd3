/** What pages read of notes. */
import { queryOptions } from "@tanstack/react-query";
import { api, items } from "../client";

export type NoteFilter = { run_id: number } | { maneuver_id: number } | { aircraft_id: number };

export const notesQuery = (filter: NoteFilter) =>
  queryOptions({
    queryKey: ["notes", filter],
    queryFn: ({ signal }) => items(api.GET("/api/v1/notes", { params: { query: filter }, signal })),
  });

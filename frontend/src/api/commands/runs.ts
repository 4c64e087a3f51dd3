/** Requests estimation runs. */
import { useMutation } from "@tanstack/react-query";
import { api, body } from "../client";
import type { RunRequest } from "../types";
import { useRefreshRuns } from "./refresh";

export function useSubmitRuns() {
  return useMutation({
    mutationFn: (requests: RunRequest[]) =>
      Promise.all(requests.map((request) => body(api.POST("/api/v1/runs", { body: request })))),
    onSettled: useRefreshRuns(),
  });
}

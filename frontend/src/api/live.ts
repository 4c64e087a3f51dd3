/** News of jobs as they happen: one stream per page, which puts what it hears into the cache. */
import { useQueryClient, type QueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import type { Job } from "./types";

/** Read again, together and not more often than this, however much happens. */
const REST_MS = 700;
const LISTS = [
  ...[["runs"], ["jobs"], ["batches"], ["batch"], ["queue"], ["maneuvers"], ["searches"]],
  ["quality", "list"],
];

/** Listens as long as the frame is there; the browser connects again by itself. */
export function useLive() {
  const cache = useQueryClient();
  useEffect(() => {
    if (typeof EventSource === "undefined") return;
    const refresh = coalesce(() => {
      for (const queryKey of LISTS) void cache.invalidateQueries({ queryKey });
      void cache.invalidateQueries({ queryKey: ["designs"], exact: true });
      void cache.invalidateQueries({
        predicate: ({ queryKey }) => queryKey[2] === "preflight_simulations",
      });
    });
    const stream = new EventSource("/api/v1/events");
    stream.onopen = () => {
      // What happened before the stream was there, or while it was lost.
      for (const queryKey of [["job"], ["run"]]) void cache.invalidateQueries({ queryKey });
      refresh();
    };
    stream.addEventListener("missed", refresh);
    stream.addEventListener("job", (event: MessageEvent<string>) => {
      const { job_id } = JSON.parse(event.data) as { job_id: number };
      void cache.invalidateQueries({ queryKey: ["job", job_id] });
      refresh();
    });
    stream.addEventListener("running", (event: MessageEvent<string>) => {
      show(cache, JSON.parse(event.data) as Job[]);
    });
    return () => {
      stream.close();
    };
  }, [cache]);
}

/** Progress of jobs goes straight to where it is shown. */
function show(cache: QueryClient, running: Job[]) {
  const byId = new Map(running.map((job) => [job.id, job]));
  for (const job of running) {
    if (cache.getQueryData(["job", job.id]) !== undefined) cache.setQueryData(["job", job.id], job);
  }
  cache.setQueriesData<Job[]>({ queryKey: ["jobs"] }, (jobs) =>
    jobs?.map((job) => byId.get(job.id) ?? job),
  );
}

/** Calls at once, then at most once per rest. */
function coalesce(act: () => void): () => void {
  let waiting = false;
  let last = 0;
  return () => {
    if (waiting) return;
    waiting = true;
    window.setTimeout(
      () => {
        waiting = false;
        last = Date.now();
        act();
      },
      Math.max(0, last + REST_MS - Date.now()),
    );
  };
}

/** News of runs as they happen: one stream per page, which puts what it hears into the cache. */
import { useQueryClient, type QueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import type { Job } from "./types";

/** Read again, together and not more often than this, however much happens. */
const REST_MS = 700;
const LISTS = [["runs"], ["jobs"], ["batches"], ["batch"], ["queue"], ["maneuvers"]];

let heard = false;

/** Whether news come by themselves; while they do not, pages ask. */
export const isLive = () => heard;

/** Listens as long as the frame is there; the browser connects again by itself. */
export function useLive() {
  const cache = useQueryClient();
  useEffect(() => {
    if (typeof EventSource === "undefined") return;
    const refresh = together(() => {
      for (const queryKey of LISTS) void cache.invalidateQueries({ queryKey });
    });
    const stream = new EventSource("/api/v1/events");
    stream.onopen = () => {
      heard = true;
      refresh();
    };
    stream.onerror = () => {
      heard = false;
    };
    stream.addEventListener("missed", refresh);
    stream.addEventListener("run", (event: MessageEvent<string>) => {
      const { run_id } = JSON.parse(event.data) as { run_id: number };
      void cache.invalidateQueries({ queryKey: ["job", run_id] });
      refresh();
    });
    stream.addEventListener("running", (event: MessageEvent<string>) => {
      show(cache, JSON.parse(event.data) as Job[]);
    });
    return () => {
      heard = false;
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
function together(act: () => void): () => void {
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

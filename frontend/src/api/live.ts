/** News of jobs as they happen: one stream per page, which puts what it hears into the cache. */
import { useQueryClient, type QueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { renew } from "./renew";
import { isOver, type Job } from "./types";

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
      for (const queryKey of LISTS) void renew(cache, { queryKey });
      void renew(cache, { queryKey: ["designs"], exact: true });
      void renew(cache, {
        predicate: ({ queryKey }) => queryKey[2] === "preflight_simulations",
      });
    });
    const stream = new EventSource("/api/v1/events");
    const refreshAll = () => {
      for (const queryKey of [["job"], ["run"]]) void renew(cache, { queryKey });
      refresh();
    };
    // What happened before the stream was there, or while it was lost.
    stream.onopen = refreshAll;
    stream.addEventListener("missed", refreshAll);
    stream.addEventListener("job", (event: MessageEvent<string>) => {
      const { job_id } = JSON.parse(event.data) as { job_id: number };
      void renew(cache, { queryKey: ["job", job_id] });
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
  // Progress that was sent before the end of a job may arrive after it.
  const update = (known: Job): Job => (isOver(known.state) ? known : (byId.get(known.id) ?? known));
  for (const { id } of running) {
    cache.setQueryData<Job>(["job", id], (known) => known && update(known));
  }
  cache.setQueriesData<Job[]>({ queryKey: ["jobs"] }, (jobs) => jobs?.map(update));
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

/** What changes on the server: one stream of events per page, which renews the cache. */
import { useQueryClient, type QueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { renew } from "./renew";
import { isOver, type Job } from "./types";

/** Read again, together and not more often than this, however much happens. */
const REST_MS = 700;
const RECONNECT_MS = 3000;
/** A page that opens is drawn before it is read again. */
const SETTLED_MS = 1500;
const LISTS = [
  ...[["runs"], ["jobs"], ["batches"], ["batch"], ["queue"], ["maneuvers"], ["searches"]],
  ["quality", "list"],
  ["dashboard"],
  ["conditions"],
];

/** Queries of each sort of records that a team changes, by the name in the event. */
const QUERIES_OF: Record<string, string[]> = {
  decisions: ["decisions", "notifications", "dashboard", "conditions"],
  model_structures: ["structures", "notifications"],
  notes: ["notes"],
  review_rules: ["review-rules", "decisions", "notifications"],
  live_streams: ["streams", "stream"],
  health: ["health"],
};

/** Listens as long as the frame is there, and connects again. */
export function useServerEvents() {
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
    const refreshAll = () => {
      for (const queryKey of [["job"], ["run"]]) void renew(cache, { queryKey });
      renewRecords(cache, Object.keys(QUERIES_OF));
      refresh();
    };
    let stream: EventSource;
    let timer: number | undefined;
    let first: number | undefined;
    const connect = () => {
      stream = new EventSource("/api/v1/events");
      // What happened before the stream was there, or while it was lost.
      stream.onopen = () => {
        if (first === undefined) first = window.setTimeout(refreshAll, SETTLED_MS);
        else refreshAll();
      };
      stream.onerror = () => {
        renewRecords(cache, ["health"]);
        // After a response that is no stream, as of a proxy, the browser does not connect again.
        if (stream.readyState === EventSource.CLOSED) {
          timer = window.setTimeout(connect, RECONNECT_MS);
        }
      };
      stream.addEventListener("missed", refreshAll);
      stream.addEventListener("changed", (event: MessageEvent<string>) => {
        renewRecords(cache, (JSON.parse(event.data) as { records: string[] }).records);
      });
      stream.addEventListener("job", (event: MessageEvent<string>) => {
        const { job_id } = JSON.parse(event.data) as { job_id: number };
        void renew(cache, { queryKey: ["job", job_id] });
        refresh();
      });
      stream.addEventListener("running", (event: MessageEvent<string>) => {
        show(cache, JSON.parse(event.data) as Job[]);
      });
    };
    connect();
    return () => {
      window.clearTimeout(timer);
      window.clearTimeout(first);
      stream.close();
    };
  }, [cache]);
}

/** Reads again what is shown of these records; the history of a stream is not among it. */
export function renewRecords(cache: QueryClient, records: readonly string[]) {
  const keys = new Set(records.flatMap((name) => QUERIES_OF[name] ?? []));
  void renew(cache, {
    predicate: ({ queryKey }) => keys.has(String(queryKey[0])) && queryKey[2] !== "history",
  });
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

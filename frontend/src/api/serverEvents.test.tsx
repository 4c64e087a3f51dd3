import { QueryClient, QueryClientProvider, QueryObserver } from "@tanstack/react-query";
import { act, renderHook, waitFor } from "@testing-library/react";
import type { ReactNode } from "react";
import { afterEach, expect, it, vi } from "vitest";
import { useServerEvents } from "./serverEvents";

class FakeSource extends EventTarget {
  static readonly CLOSED = 2;
  static opened: FakeSource[] = [];
  readyState = 1;
  onopen: (() => void) | null = null;
  onerror: (() => void) | null = null;
  constructor() {
    super();
    FakeSource.opened.push(this);
  }
  close() {
    this.readyState = FakeSource.CLOSED;
  }
}

afterEach(() => {
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

function listen() {
  FakeSource.opened = [];
  vi.stubGlobal("EventSource", FakeSource);
  const cache = new QueryClient({ defaultOptions: { queries: { staleTime: Infinity } } });
  const wrapper = ({ children }: { children: ReactNode }) => (
    <QueryClientProvider client={cache}>{children}</QueryClientProvider>
  );
  renderHook(
    () => {
      useServerEvents();
    },
    { wrapper },
  );
  return cache;
}

it("reads again what others have changed, and nothing else", async () => {
  const cache = listen();
  const reads: string[] = [];
  for (const queryKey of [["decisions", 3], ["notes"], ["stream", 1, "history", 0]]) {
    const queryFn = () => Promise.resolve(reads.push(String(queryKey[0])));
    new QueryObserver(cache, { queryKey, queryFn }).subscribe(() => undefined);
  }
  await waitFor(() => {
    expect(reads).toHaveLength(3);
  });
  act(() => {
    const data = JSON.stringify({ records: ["decisions", "live_streams"] });
    FakeSource.opened[0]?.dispatchEvent(new MessageEvent("changed", { data }));
  });
  await waitFor(() => {
    expect(reads.slice(3)).toEqual(["decisions"]);
  });
});

it("connects again after a response that was no stream", () => {
  vi.useFakeTimers();
  listen();
  const first = FakeSource.opened[0];
  first?.close();
  first?.onerror?.();
  vi.advanceTimersByTime(10_000);
  expect(FakeSource.opened).toHaveLength(2);
});

it("reads again once it is drawn what changed before the stream was there", async () => {
  vi.useFakeTimers();
  const cache = listen();
  let reads = 0;
  const queryFn = () => Promise.resolve(++reads);
  new QueryObserver(cache, { queryKey: ["runs"], queryFn }).subscribe(() => undefined);
  await vi.advanceTimersByTimeAsync(100);
  const stream = FakeSource.opened[0];
  stream?.onopen?.();
  await vi.advanceTimersByTimeAsync(1000);
  expect(reads).toBe(1);
  await vi.advanceTimersByTimeAsync(2000);
  expect(reads).toBe(2);
  stream?.onopen?.(); // connected again: what happened meanwhile is read at once
  await vi.advanceTimersByTimeAsync(1000);
  expect(reads).toBe(3);
});

import { QueryClient, QueryClientProvider } from "@tanstack/react-query";
import { act, renderHook, waitFor } from "@testing-library/react";
import type { ReactNode } from "react";
import { expect, it, vi } from "vitest";
import type { Job } from "./types";
import { useStoredResult } from "./useStoredResult";

it("sends the first request at once and a changed one on demand", async () => {
  const submit = vi.fn(() => Promise.resolve({ id: 7, state: "queued" } as Job));
  const client = new QueryClient();
  const wrapper = ({ children }: { children: ReactNode }) => (
    <QueryClientProvider client={client}>{children}</QueryClientProvider>
  );
  const { result, rerender } = renderHook(
    ({ fuel }: { fuel: number }) =>
      useStoredResult({
        key: ["flutter", fuel],
        enabled: true,
        read: () => Promise.resolve(fuel),
        find: () => Promise.resolve({ job: null }),
        submit,
      }),
    { wrapper, initialProps: { fuel: 0.5 } },
  );
  await waitFor(() => {
    expect(result.current.jobId).toBe(7);
  });
  rerender({ fuel: 0.6 });
  expect(submit).toHaveBeenCalledTimes(1);
  expect(result.current.jobId).toBeUndefined();
  act(() => {
    result.current.compute?.();
  });
  await waitFor(() => {
    expect(submit).toHaveBeenCalledTimes(2);
  });
  expect(result.current.compute).toBeUndefined();
});

import { QueryClient, QueryObserver } from "@tanstack/react-query";
import { expect, it, vi } from "vitest";
import { renew } from "./renew";

it("reads again after a first response that may be older than the change", async () => {
  const responses: ((state: string) => void)[] = [];
  const cache = new QueryClient();
  const observer = new QueryObserver(cache, {
    queryKey: ["job", 2],
    queryFn: () => new Promise<string>((resolve) => responses.push(resolve)),
  });
  const stop = observer.subscribe(() => undefined);
  const renewed = renew(cache, { queryKey: ["job"] });
  responses[0]?.("running");
  await vi.waitFor(() => {
    expect(responses).toHaveLength(2);
  });
  responses[1]?.("succeeded");
  await renewed;
  expect(cache.getQueryData(["job", 2])).toBe("succeeded");
  stop();
});

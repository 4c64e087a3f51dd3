/** Reading again what has changed on the server. */
import type { InvalidateQueryFilters, QueryClient } from "@tanstack/react-query";

/**
 * Marks queries as outdated, those too whose first response is under way.
 *
 * Such a response may be older than the change, and an invalidation alone only waits for it.
 */
export async function renew(cache: QueryClient, filters: InvalidateQueryFilters): Promise<void> {
  const first = cache
    .getQueryCache()
    .findAll({ ...filters, fetchStatus: "fetching" })
    .filter((query) => query.state.data === undefined);
  await Promise.all([
    cache.invalidateQueries(filters),
    ...first.map(async (query) => {
      await Promise.allSettled([query.promise]);
      await cache.invalidateQueries({ queryKey: query.queryKey, exact: true });
    }),
  ]);
}

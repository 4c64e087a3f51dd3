import { useInfiniteQuery } from "@tanstack/react-query";
import { maneuversQuery } from "../../api/queries";
import type { ManeuverItem } from "../../api/types";

/**
 * Maneuver proposed for the next estimate: without a run, and with the least correlated inputs,
 * whose derivatives are separated best. Null if there are no maneuvers, undefined while loading.
 */
export function useProposedManeuver(): ManeuverItem | null | undefined {
  const separable = useInfiniteQuery(maneuversQuery({}, "max_input_correlation", 50));
  const untouched = useInfiniteQuery(maneuversQuery({}, "n_runs", 1));
  if (separable.data === undefined || untouched.data === undefined) return undefined;
  const withoutRun = separable.data.pages[0]?.items.find(
    (one) => one.n_runs === 0 && one.max_input_correlation !== null,
  );
  return withoutRun ?? untouched.data.pages[0]?.items[0] ?? null;
}

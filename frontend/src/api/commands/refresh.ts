/** What has to be read again after a change. */
import { useQueryClient } from "@tanstack/react-query";
import { renew } from "../renew";

/** Everything that shows a run: its own page, lists, and the badges of the campaign. */
export const RUN_VIEWS = [
  ...[["runs"], ["run"], ["jobs"], ["job"], ["maneuvers"]],
  ...[["batches"], ["batch"], ["queue"]],
];

export function useRefreshRuns() {
  const cache = useQueryClient();
  return () => Promise.all(RUN_VIEWS.map((queryKey) => renew(cache, { queryKey })));
}

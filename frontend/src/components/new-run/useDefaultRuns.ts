import { useQuery } from "@tanstack/react-query";
import { globalModelVersionsQuery } from "../../api/queries";
import type { VARIATIONS } from "../../views";

interface FusedView {
  runs?: number[];
  variation?: (typeof VARIATIONS)[number];
}

/** The view, without selected runs that of the approved global model, which is returned too. */
export function useDefaultRuns<View extends FusedView>(view: View, enabled = true) {
  const needed = enabled && view.runs === undefined;
  const versions = useQuery({ ...globalModelVersionsQuery(), enabled: needed });
  const approved = needed ? versions.data?.find((one) => one.state === "approved") : undefined;
  if (approved === undefined) return { view, approved };
  const runs = approved.runs.filter((run) => !run.is_outlying).map((run) => run.run_id);
  return { view: { ...view, runs, variation: view.variation ?? "global-model" }, approved };
}

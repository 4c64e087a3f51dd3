import { useQuery } from "@tanstack/react-query";
import { controllersQuery, maneuverQuery, runQuery } from "../../api/queries";

/** Controllers of the aircraft of a run; of all aircraft without a run. */
export function useControllersOf(runId: number | undefined) {
  const controllers = useQuery(controllersQuery);
  const run = useQuery({ ...runQuery(runId ?? 0), enabled: runId !== undefined });
  const maneuverId = run.data?.maneuver_id;
  const maneuver = useQuery({
    ...maneuverQuery(maneuverId ?? 0),
    enabled: maneuverId !== undefined,
  });
  const known = controllers.data ?? [];
  if (runId === undefined) return known;
  return known.filter((one) => one.aircraft_id === maneuver.data?.aircraft_id);
}

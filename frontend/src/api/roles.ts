/** What the account that is logged in may do in a campaign. */
import { useQuery } from "@tanstack/react-query";
import { sessionQuery } from "./queries";
import type { Role } from "./types";

/** Each role includes the ones before it. */
export const ROLES: readonly Role[] = ["viewer", "analyst", "reviewer", "admin"];

/** Whether the account has at least this role in a campaign; without accounts everybody has. */
export function useMay(least: Role, aircraftId: number | null | undefined): boolean {
  const { data } = useQuery(sessionQuery);
  if (data === undefined || data.mode === "personal") return true;
  return data.roles.some(
    ({ aircraft_id, role }) =>
      (aircraft_id === null || aircraft_id === aircraftId) &&
      ROLES.indexOf(role) >= ROLES.indexOf(least),
  );
}

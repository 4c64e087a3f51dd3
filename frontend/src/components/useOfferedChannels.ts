import { useQuery } from "@tanstack/react-query";
import { aircraftQuery } from "../api/queries";
import type { Maneuver } from "../api/types";
import { byRole, combined } from "../lib/channels";

/** Channels of a maneuver by role, with what the aircraft combines from them. */
export function useOfferedChannels(maneuver: Maneuver) {
  const aircraft = useQuery(aircraftQuery);
  const own = aircraft.data?.find((one) => one.id === maneuver.aircraft_id);
  const names = combined(maneuver.channels, own?.combinations ?? []);
  return (roles?: Parameters<typeof byRole>[1]) => {
    const groups = byRole(maneuver.channels, roles);
    if (names.length === 0) return groups;
    const combinations = { label: "Combined", items: names.map((name) => ({ name, note: "" })) };
    const after = groups.findIndex((group) => group.label === "Inputs") + 1;
    return groups.toSpliced(after, 0, combinations);
  };
}

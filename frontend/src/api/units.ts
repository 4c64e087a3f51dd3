/** Display units: those of the address, else those that the user prefers. */
import { useQuery } from "@tanstack/react-query";
import { useSearch } from "@tanstack/react-router";
import { useCallback, useMemo } from "react";
import { storePreference, usePreference } from "./preference";
import { displayUnitsQuery, sessionQuery } from "./queries";
import { FREQUENCY_UNITS, UNIT_SYSTEMS, type DisplayUnits } from "./types";

export const DEFAULT_UNITS: DisplayUnits = { units: "metric", frequency_unit: "Hz" };

const KEY = "flexsid.units";

/** The units that are known among those that an address or the storage names. */
function known(given: { units?: unknown; frequency_unit?: unknown }): Partial<DisplayUnits> {
  return {
    units: UNIT_SYSTEMS.find((one) => one === given.units),
    frequency_unit: FREQUENCY_UNITS.find((one) => one === given.frequency_unit),
  };
}

/** Stores the preference of a user without an account, in this browser. */
export function storeUnits(units: DisplayUnits): void {
  storePreference(KEY, units);
}

/** The units that the user prefers: of the account, else of this browser. */
export function usePreferredUnits(): DisplayUnits {
  const { data } = useQuery(sessionQuery);
  const own = usePreference(KEY);
  return useMemo(() => {
    const given = data?.units != null ? known(data) : known(own);
    return {
      units: given.units ?? DEFAULT_UNITS.units,
      frequency_unit: given.frequency_unit ?? DEFAULT_UNITS.frequency_unit,
    };
  }, [data, own]);
}

/** The units of this address, else the preferred ones. */
export function useDisplayUnits(): DisplayUnits {
  const preferred = usePreferredUnits();
  const { units, frequency_unit } = known(useSearch({ strict: false }));
  return {
    units: units ?? preferred.units,
    frequency_unit: frequency_unit ?? preferred.frequency_unit,
  };
}

/** The parameters of figures and reports, without those that are the default of the API. */
export function useUnitParameters(): Partial<DisplayUnits> {
  const { units, frequency_unit } = useDisplayUnits();
  return {
    units: units === DEFAULT_UNITS.units ? undefined : units,
    frequency_unit: frequency_unit === DEFAULT_UNITS.frequency_unit ? undefined : frequency_unit,
  };
}

/** Units of addresses and forms that are not SI: their SI unit, and its value of one. */
const OTHERS: Partial<Record<string, [string, number]>> = {
  deg: ["rad", Math.PI / 180],
  "deg/s": ["rad/s", Math.PI / 180],
  "deg/s²": ["rad/s2", Math.PI / 180],
  g: ["m/s2", 9.80665],
};

/** Name and factor of the display unit of a unit: displayed = factor * value in the unit. */
export function useConversion() {
  const { data } = useQuery(displayUnitsQuery(useDisplayUnits()));
  return useCallback(
    (unit: string): { name: string; factor: number } => {
      const [base, size] = OTHERS[unit] ?? [unit, 1];
      const found = data?.find((one) => one.unit === base);
      if (found === undefined || found.display_unit === unit) return { name: unit, factor: 1 };
      return { name: found.display_unit, factor: found.factor * size };
    },
    [data],
  );
}

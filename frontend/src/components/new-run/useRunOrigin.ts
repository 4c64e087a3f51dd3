import { useQuery } from "@tanstack/react-query";
import { structureVersionsQuery, maneuverBaselinesQuery } from "../../api/queries";
import type { Baseline, StructureVersion } from "../../api/types";

const MOST_ASKED = 200;

/** The stored structure that a new run starts from. */
export interface RunOrigin {
  structure: StructureVersion;
  /** Baseline of the condition, if the structure is one. */
  baseline?: Baseline;
  /** Baselines of further maneuvers, where they differ. */
  ofAdditional: Map<number, StructureVersion>;
  /** All maneuvers that were asked for have an approved structure. */
  everywhere: boolean;
}

interface Asked {
  structure?: number;
  version?: number;
  additional_maneuvers?: number[];
}

/**
 * The structure that the address names, else the baseline of the maneuver; an origin
 * of undefined where there is none.
 */
export function useRunOrigin(maneuver: number, asked: Asked, template: number | undefined) {
  const named = template === undefined && asked.structure !== undefined;
  const versions = useQuery({
    ...structureVersionsQuery(asked.structure ?? 0),
    enabled: named,
  });
  const baselines = useQuery({
    ...maneuverBaselinesQuery(
      [maneuver, ...(asked.additional_maneuvers ?? [])].slice(0, MOST_ASKED),
    ),
    enabled: template === undefined && !named,
  });
  const origin = (): RunOrigin | undefined => {
    if (named) {
      const found = versions.data?.find((one) => one.version === asked.version);
      const structure = asked.version === undefined ? versions.data?.at(-1) : found;
      return structure && { structure, ofAdditional: new Map(), everywhere: false };
    }
    const [own, ...rest] = baselines.data ?? [];
    if (!own?.baseline) return undefined;
    const { baseline } = own;
    const ofAdditional = new Map(
      rest.flatMap((one) =>
        one.baseline !== null && one.baseline.structure.id !== baseline.structure.id
          ? [[one.maneuver_id, one.baseline.structure] as const]
          : [],
      ),
    );
    const everywhere =
      rest.length === (asked.additional_maneuvers?.length ?? 0) &&
      rest.every((one) => one.baseline !== null);
    return { structure: baseline.structure, baseline, ofAdditional, everywhere };
  };
  const query = named ? versions : baselines;
  return {
    loading: template === undefined && query.isPending,
    error: query.error,
    origin: origin(),
  };
}

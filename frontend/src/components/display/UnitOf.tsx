import { useQuery } from "@tanstack/react-query";
import { unitsQuery } from "../../api/queries";

/** The unit of a parameter in brackets; nothing for a pure number. All of a table ask at once. */
export function UnitOf({ name, among }: { name: string; among: readonly string[] }) {
  const unit = useQuery(unitsQuery(among)).data?.[name];
  return unit === undefined ? null : <span className="unit"> [{unit}]</span>;
}

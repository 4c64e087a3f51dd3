import { useQuery } from "@tanstack/react-query";
import { runQuery } from "../../api/queries";
import type { ConditionSheet } from "../../api/types";
import { fixed, percent, signedWith, withError } from "../../lib/text/format";
import { DerivativeName } from "../display/DerivativeName";

const SENSORS = 3;

/** Sensors without which σ of a derivative grows most, in percent of it, and its share of noise. */
export function useSensors(sheet: ConditionSheet, name: string | undefined) {
  const run = useQuery({
    ...runQuery(sheet.reference_run_id ?? 0),
    enabled: sheet.reference_run_id !== null && name !== undefined,
  });
  const place = run.data?.parameters.findIndex((one) => one.name === name) ?? -1;
  const sensors = (run.data?.adequacy?.without_sensors ?? [])
    .flatMap((one) => {
      const ratio = one.std_ratios[place];
      return ratio == null ? [] : [{ output: one.output, growth: 100 * (ratio - 1) }];
    })
    .sort((a, b) => b.growth - a.growth)
    .slice(0, SENSORS);
  return { sensors, noise: run.data?.retained?.noise_share[name ?? ""] };
}

/** One line on the pressed derivative: its variance, the sensors behind it, its partners. */
export function SelectedDerivative({ sheet, name }: { sheet: ConditionSheet; name?: string }) {
  const { sensors, noise } = useSensors(sheet, name);
  const index = sheet.rows.findIndex((row) => row.name === name);
  const row = sheet.rows[index];
  if (row === undefined) return null;
  const { value, error } = withError(row.value, 2 * (row.std_error ?? 0));
  const partners = sheet.pairs.filter((one) => one.first === name || one.second === name);
  const repeats = sheet.sources.flatMap((source, at) => {
    const found = row.values[at];
    return source.role === "repeat" && found?.deviation_sigma != null
      ? [`${source.maneuver_label} ${signedWith(found.deviation_sigma, 1, "σ")}`]
      : [];
  });
  return (
    <p className="sheet-selected" role="status" data-testid="sheet-selected">
      <strong>
        <DerivativeName name={row.name} />
      </strong>{" "}
      {value} ± {error}.{" "}
      {row.modal_share !== null && row.modal_share > 0.005 && (
        <>{percent(row.modal_share)} % of its variance stems from the modal data. </>
      )}
      {noise !== undefined && <>{percent(noise)} % of the rest is noise. </>}
      {sensors.length > 0 && (
        <>
          Its σ grows without{" "}
          {sensors.map((one) => `${one.output} by ${fixed(one.growth, 0)} %`).join(", ")}.{" "}
        </>
      )}
      {partners.map((one) => (
        <span key={`${one.first} ${one.second}`}>
          ρ = {fixed(one.correlation, 2)} with{" "}
          <DerivativeName name={one.first === name ? one.second : one.first} />.{" "}
        </span>
      ))}
      {repeats.length > 0 && <>Repeats: {repeats.join(", ")}.</>}
    </p>
  );
}

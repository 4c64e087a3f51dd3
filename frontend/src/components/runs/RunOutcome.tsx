import { Text } from "@mantine/core";
import type { Fit, Run } from "../../api/types";
import { fixed, significant } from "../../lib/text/format";
import { Facts } from "../display/ConditionFacts";

/** Outcome of the estimation and its key figures. */
export function RunOutcome({ run, fit }: { run: Run; fit: Fit }) {
  const values = Object.values(fit.r_squared).filter((value) => Number.isFinite(value));
  const sorted = [...values].sort((a, b) => a - b);
  const median = sorted[Math.floor(sorted.length / 2)];
  return (
    <>
      <Text size="sm" mb="sm" data-testid="run-outcome">
        {fit.message}
        {fit.noise !== "" &&
          ` Weights: ${fit.noise}, ${String(fit.noise_degrees_of_freedom)} degrees of freedom.`}
      </Text>
      <Facts
        facts={[
          ["Median R²", fixed(median, 3)],
          ["Lowest R²", fixed(sorted[0], 3)],
          ["Cost", significant(fit.cost, 6)],
          ["Iterations", fit.iterations.at(-1)?.iteration ?? 0],
          ["Parameters", fit.n_parameters],
          ["Frequencies", fit.n_lines],
          ["Modes", run.structure.modes.join(", ") || "rigid"],
          ["Nuisance modes", run.retained?.modes.join(", ") ?? "none"],
          ["Spread of the prediction", fixed(run.retained && 100 * run.retained.spread, 0), "%"],
          ["Spread of mode shapes", fixed(run.shape_spread && 100 * run.shape_spread, 1), "%"],
          ["Start", fit.start.replaceAll("-", " ")],
          ["Computing time", fixed(fit.seconds, 2), "s"],
        ]}
      />
      {fit.warnings.length > 0 && (
        <ul className="warnings" aria-label="Warnings">
          {fit.warnings.map((warning) => (
            <li key={warning}>{warning}</li>
          ))}
        </ul>
      )}
    </>
  );
}

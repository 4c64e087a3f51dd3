import { Stack, Text } from "@mantine/core";
import type { Comparison } from "../../api/types";
import { significant } from "../../lib/text/format";

/** How the runs agree among each other, and how each prediction agrees with them. */
export function ComparisonVerdicts({ comparison }: { comparison: Comparison }) {
  const { runs_verdict: runs, prediction_verdicts: predictions } = comparison;
  const labels = new Map(comparison.sources.map((source) => [source.key, source.label]));
  const several = comparison.sources.filter((source) => source.kind !== "prediction").length > 1;
  return (
    <Stack gap={2} align="flex-end" data-testid="verdicts">
      <Text size="sm" className="quiet numbers">
        {runs.n_judged > 0
          ? `${runs.n_consistent} of ${runs.n_judged} derivatives agree between runs; of correct estimates ${significant(100 * runs.false_alarm_rate, 2)} % do not`
          : several
            ? "No two runs give standard errors for the same derivative"
            : "Two runs are needed to judge consistency"}
      </Text>
      {predictions.map((one) => (
        <Text key={one.source} size="sm" className="quiet numbers">
          {one.n_judged > 0
            ? `${labels.get(one.source ?? "")}: ${one.n_consistent} of ${one.n_judged} agree with ${several ? "every run" : "the run"}`
            : `${labels.get(one.source ?? "")}: no standard errors, not judged`}
        </Text>
      ))}
    </Stack>
  );
}

import type { RunItem } from "../../api/types";
import { ButtonLink } from "../controls/ButtonLink";

interface Props {
  runs: Pick<RunItem, "id" | "prediction_id">[];
  label: string;
}

/** To the comparison of these runs, with the predictions that they know of. */
export function CompareLink({ runs, label }: Props) {
  const predictions = [...new Set(runs.flatMap((run) => run.prediction_id ?? []))];
  return (
    <ButtonLink
      to="/compare"
      search={{ runs: runs.map((run) => run.id), predictions }}
      variant="default"
      disabled={runs.length === 0}
      data-testid="compare-link"
    >
      {label}
    </ButtonLink>
  );
}

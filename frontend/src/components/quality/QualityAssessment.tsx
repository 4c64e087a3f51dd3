/** Quality of the data of the maneuvers of a campaign. */
import { Button, Group, Progress, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { useAssess } from "../../api/commands";
import { assessmentQuery } from "../../api/queries";
import type { ManeuverItem } from "../../api/types";
import { count, fixed, percent } from "../../lib/text/format";
import type { Column } from "../controls/DataTable";
import { ProblemAlert } from "../display/ProblemAlert";
import { VerdictBadge } from "../display/VerdictBadge";

/** Verdict on the data of a maneuver, with the way to its reasons. */
export const VERDICT_COLUMN: Column<ManeuverItem> = {
  key: "verdict",
  header: "Verdict",
  sort: "verdict",
  render: (one) => (
    <Link
      to="/maneuvers/$id"
      params={{ id: one.id }}
      search={{ tab: "quality" }}
      className="link"
      title={one.summary ?? undefined}
    >
      <VerdictBadge verdict={one.verdict} />
    </Link>
  ),
};

/** Quality of the data of a maneuver. */
export const QUALITY_COLUMNS: Column<ManeuverItem>[] = [
  VERDICT_COLUMN,
  {
    key: "signal",
    onlyIf: (one) => one.figures?.signal_to_noise_db != null,
    header: <span title="Median of all outputs over all frequencies">Signal/noise</span>,
    unit: "dB",
    sort: "signal_to_noise_db",
    numeric: true,
    render: (one) => fixed(one.figures?.signal_to_noise_db, 0),
  },
  {
    key: "coherence",
    onlyIf: (one) => one.figures?.least_coherence != null,
    header: <span title="Lowest coherence of a sensor with the others">Coherence</span>,
    sort: "least_coherence",
    numeric: true,
    render: (one) => fixed(one.figures?.least_coherence, 2),
  },
  {
    key: "skew",
    onlyIf: (one) => one.figures?.largest_skew_s != null,
    header: "Largest skew",
    unit: "ms",
    sort: "largest_skew_s",
    numeric: true,
    render: (one) =>
      one.figures?.largest_skew_s == null
        ? "–"
        : `${fixed(1e3 * one.figures.largest_skew_s, 1)} ${one.figures.largest_skew_channel ?? ""}`,
  },
  {
    key: "spikes",
    onlyIf: (one) => one.figures?.n_stretches != null,
    header: <span title="Spikes, dropouts and saturated intervals">Spikes</span>,
    sort: "n_stretches",
    numeric: true,
    render: (one) => one.figures?.n_stretches ?? "–",
  },
  {
    key: "drift",
    onlyIf: (one) => one.figures?.airspeed_drift != null,
    header: "Airspeed drift",
    unit: "%",
    sort: "airspeed_drift",
    numeric: true,
    render: (one) => percent(one.figures?.airspeed_drift, 1),
  },
  {
    key: "summary",
    onlyIf: (one) => one.summary != null,
    header: "Summary",
    wraps: true,
    render: (one) => (
      <span style={{ display: "block", maxWidth: 460, whiteSpace: "normal" }}>
        {one.summary ?? "–"}
      </span>
    ),
  },
];

/** Quality check of new maneuvers; results are stored, so that each is computed once. */
export function AssessButton() {
  const assess = useAssess();
  const { data } = useQuery(assessmentQuery);
  if (data === undefined) return null;
  const { assessing } = data;
  const missing = data.counts.missing ?? 0;
  if (assess.isError) return <ProblemAlert error={assess.error} />;
  if (assessing.running) {
    return (
      <Group gap="sm" data-testid="assessing">
        <Progress
          w={160}
          value={(100 * assessing.done) / Math.max(1, assessing.total)}
          aria-label="Checked maneuvers"
        />
        <Text size="sm" className="numbers">
          {assessing.done} of {assessing.total}
        </Text>
        <Button
          variant="default"
          loading={assess.isPending}
          onClick={() => {
            assess.mutate("stop");
          }}
        >
          Cancel
        </Button>
      </Group>
    );
  }
  return (
    <Button
      disabled={missing === 0}
      loading={assess.isPending}
      data-testid="assess"
      onClick={() => {
        assess.mutate("begin");
      }}
    >
      {missing === 0 ? "All checked" : `Check ${count(missing, "maneuver")}`}
    </Button>
  );
}

import { Alert } from "@mantine/core";
import type { PredictedFlutter as Result } from "../../api/types";
import type { useStoredResult } from "../../api/useStoredResult";
import { fixed, hertz, percent } from "../../lib/text/format";
import { ComputeButton } from "../controls/ComputeButton";
import { Facts } from "../display/ConditionFacts";
import { JobWait } from "../jobs/JobWait";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";
import { Quantity, quantityFact, Sentence } from "../display/Quantity";
import { Section } from "../display/Section";

/** The flutter analysis of a prediction: its job, then its result. */
export function StoredPredictedFlutter({
  stored,
}: {
  stored: ReturnType<typeof useStoredResult<Result>>;
}) {
  const { result, jobId, error, onEnd, compute } = stored;
  return (
    <>
      <ComputeButton compute={compute} />
      {error !== null && <ProblemAlert error={error} />}
      {jobId !== undefined && <JobWait key={jobId} id={jobId} onEnd={onEnd} />}
      {compute === undefined && jobId === undefined && error === null && (
        <Loaded query={result} rows={4}>
          {(data) => <PredictedFlutter result={data} />}
        </Loaded>
      )}
    </>
  );
}

/** Flutter of a prediction alone: p-k method, rational functions, and mode participation. */
function PredictedFlutter({ result }: { result: Result }) {
  const parts = result.participation
    .filter((one) => one.share >= 0.01)
    .map((one) => `${one.name} ${percent(one.share)} %`);
  return (
    <Section
      title="Flutter of the prediction"
      note={
        <>
          {result.source}; modes {result.modes.join(" ")}, from{" "}
          <Quantity value={result.searched_from_m_s} unit="m/s" decimals={1} /> to{" "}
          <Quantity value={result.searched_to_m_s} unit="m/s" decimals={1} named />
        </>
      }
    >
      <Alert variant="light" role="status" mb="sm" data-testid="predicted-flutter">
        <Sentence text={result.sentence} />
      </Alert>
      <Facts
        facts={[
          quantityFact("p-k method", result.airspeed_m_s, "m/s", 2),
          quantityFact(
            "±2σ",
            result.airspeed_std_m_s === null ? null : 2 * result.airspeed_std_m_s,
            "m/s",
            2,
          ),
          quantityFact("Rational functions", result.rational_airspeed_m_s, "m/s", 2),
          quantityFact(
            "Frequency",
            result.frequency_rad_s === null ? null : hertz(result.frequency_rad_s),
            "Hz",
            3,
          ),
          ["Reduced frequency", fixed(result.reduced_frequency, 3)],
          ["Fuel", percent(result.fuel_fraction), "%"],
          quantityFact("Air density", result.density_kg_m3, "kg/m3", 3),
          ["Mode participation", parts.join(", ") || "–"],
        ]}
      />
    </Section>
  );
}

import { Alert, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { runsQuery } from "../../api/queries";
import type { DerivedRun, Run } from "../../api/types";
import { Section } from "../display/Section";

/** Refits that a prediction rests on, as links to their runs; failed ones first. */
export function DerivedRuns({ runs }: { runs: readonly DerivedRun[] }) {
  const failed = runs.filter((one) => one.failure !== null);
  if (runs.length === 0) return null;
  return (
    <>
      {failed.length > 0 && (
        <Alert color="yellow" variant="light" title="Derived runs failed; no interval is given">
          {failed.map((one) => (
            <div key={one.derived_run_id}>
              <RunLink id={one.derived_run_id} />, derived from run {one.run_id} to {one.purpose}:{" "}
              {one.failure}
            </div>
          ))}
        </Alert>
      )}
      <Section title="Derived runs" note="Refits that the prediction rests on">
        {runs.map((one) => (
          <Text size="sm" key={one.derived_run_id}>
            <RunLink id={one.derived_run_id} />, derived from <RunLink id={one.run_id} /> to{" "}
            {one.purpose}
          </Text>
        ))}
      </Section>
    </>
  );
}

/** What a derived run is for, and the runs derived from a run. */
export function RunDerivation({ run }: { run: Run }) {
  const own = useQuery(runsQuery({ derived: true, derived_from_run_id: run.id })).data ?? [];
  const { derivation } = run;
  return (
    <>
      {run.derived_from_run_id !== null && derivation !== null && (
        <Text size="sm" mb="md" data-testid="derivation">
          Derived from <RunLink id={run.derived_from_run_id} />
          {derivation.job_id !== null &&
            ` for ${derivation.job_kind.replaceAll("-", " ")} ${derivation.job_id}`}
          , to {derivation.purpose}.
        </Text>
      )}
      {own.length > 0 && (
        <Text size="sm" mb="md">
          Derived runs:{" "}
          {own.map((one, k) => (
            <span key={one.id}>
              {k > 0 && ", "}
              <RunLink id={one.id} />
            </span>
          ))}
        </Text>
      )}
    </>
  );
}

function RunLink({ id }: { id: number }) {
  return (
    <Link to="/runs/$id" params={{ id }} className="link">
      run {id}
    </Link>
  );
}

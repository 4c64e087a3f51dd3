import { Alert } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import type { Run } from "../api/types";

/** That a result is not what the run gave, or that its data were corrected since. */
export function RunIntegrity({ run }: { run: Run }) {
  return (
    <>
      {run.altered && (
        <Alert color="red" variant="light" title="Stored result altered" mb="md">
          What is stored does not match the hash that was kept with it when the run finished: the
          result, or what was asked for, was altered since. It is not compared, reported or
          exported. Estimate again, or restore a backup.
        </Alert>
      )}
      {run.changed_since !== null && run.changed_since.length > 0 && (
        <Alert color="yellow" variant="light" title="Data changed since" mb="md">
          Changed since this run was computed: {run.changed_since.join(", ")} (samples, corrections
          or what is assumed). The result is that of the earlier data;{" "}
          <Link
            to="/maneuvers/$id/new-run"
            params={{ id: run.maneuver_id }}
            search={{ like: run.id }}
            className="link"
          >
            estimate again
          </Link>
          .
        </Alert>
      )}
    </>
  );
}

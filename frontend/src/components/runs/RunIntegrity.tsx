import { Alert } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import type { Run } from "../../api/types";

/** Warning that a result was altered, or that its data were corrected later. */
export function RunIntegrity({ run }: { run: Run }) {
  return (
    <>
      {run.altered && (
        <Alert color="red" variant="light" title="Stored result altered" mb="md">
          The stored result or request does not match the hash stored when the run finished. It is
          excluded from comparison, reports and export. Estimate again, or restore a backup.
        </Alert>
      )}
      {run.changed_since !== null && run.changed_since.length > 0 && (
        <Alert color="yellow" variant="light" title="Data changed since" mb="md">
          Changed since this run was computed: {run.changed_since.join(", ")} (samples, corrections
          or assumptions). The result belongs to the earlier data;{" "}
          <Link
            to="/maneuvers/$id/new-run"
            params={{ id: run.maneuver_id }}
            search={{ template_run: run.id }}
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

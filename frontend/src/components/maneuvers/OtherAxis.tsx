import { Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { runsQuery } from "../../api/queries";
import type { Run } from "../../api/types";
import { axisNames } from "../../lib/derivatives";
import { latestPerMethod } from "../runs/latestRuns";
import { asAxis } from "../new-run/runRequest";

/** The half that a run of a combined maneuver describes, and the way to the other half. */
export function OtherAxis({ run }: { run: Run }) {
  const runs = useQuery(runsQuery({ maneuver_id: run.maneuver_id, state: "succeeded" }));
  const axis = asAxis(run.structure.axis);
  const other = axisNames(axis).symmetry === "symmetric" ? "lateral" : "longitudinal";
  const found = latestPerMethod(runs.data ?? []).filter((one) => one.axis === other);
  const shown = found.find((one) => one.method === run.method) ?? found[0];
  return (
    <Text size="sm" data-testid="other-axis">
      <span className="quiet">The {axis} half of a combined maneuver. </span>
      {shown ? (
        <Link to="/runs/$id" params={{ id: shown.id }} className="link">
          Open the {other} half: {shown.method} run {shown.id}
        </Link>
      ) : (
        <Link
          to="/maneuvers/$id/new-run"
          params={{ id: run.maneuver_id }}
          search={{ axis: other, methods: [run.method] }}
          className="link"
        >
          Estimate the {other} half
        </Link>
      )}
    </Text>
  );
}

import { Menu } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { maneuverQuery, runsQuery } from "../../api/queries";
import type { Run } from "../../api/types";
import { axisNames } from "../../lib/derivatives";
import { latestPerMethod } from "./latestRuns";
import { asAxis } from "../new-run/runRequest";

/** Rigid aircraft for JSBSim: of the run alone, and with the newest runs of the other axis. */
export function JsbsimItems({ run }: { run: Run }) {
  const maneuver = useQuery(maneuverQuery(run.maneuver_id));
  const aircraft_id = maneuver.data?.aircraft_id;
  const runs = useQuery({
    ...runsQuery({ aircraft_id, state: "succeeded" }),
    enabled: aircraft_id !== undefined,
  });
  const axis = asAxis(run.structure.axis);
  const other = axisNames(axis).symmetry === "symmetric" ? "lateral" : "longitudinal";
  const others = latestPerMethod(runs.data ?? []).filter((one) => one.axis === other);
  const address = `/api/v1/runs/${run.id}/jsbsim`;
  return (
    <>
      <Menu.Item component="a" href={address} download={`flexsid-run-${run.id}.jsbsim.zip`}>
        Rigid aircraft for JSBSim
      </Menu.Item>
      {others.map((one) => (
        <Menu.Item
          key={one.id}
          component="a"
          href={`${address}?other_run_id=${one.id}`}
          download={`flexsid-runs-${run.id}-${one.id}.jsbsim.zip`}
        >
          JSBSim of both axes, with {other} {one.method} run {one.id} ({one.maneuver_label})
        </Menu.Item>
      ))}
    </>
  );
}

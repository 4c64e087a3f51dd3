import { Button, Menu } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { runsQuery } from "../../api/queries";
import type { Run } from "../../api/types";
import { csv, saveText } from "../../lib/text/csv";
import { latestPerMethod } from "./latestRuns";
import { ButtonLink } from "../controls/ButtonLink";
import { CompareLink } from "./CompareLink";
import { JsbsimItems } from "./JsbsimItems";
import { ReportMenu } from "../controls/ReportMenu";
import { TemplateMenu } from "../new-run/TemplateMenu";

/** Actions on a run: compare, repeat, export, delete. */
export function RunActions({ run }: { run: Run }) {
  const others = useQuery(runsQuery({ maneuver_id: run.maneuver_id, state: "succeeded" }));
  const { axis } = run.structure;
  const methods = latestPerMethod(others.data ?? []).filter(
    (one) => one.method !== run.method || one.axis !== axis,
  );
  const done = run.state === "succeeded";
  return (
    <>
      <ButtonLink
        to="/maneuvers/$id/new-run"
        params={{ id: run.maneuver_id }}
        search={{ template_run: run.id }}
        variant="default"
        data-testid="run-again"
      >
        Run again with changes
      </ButtonLink>
      <TemplateMenu run={run} />
      {done && <ReportMenu of={`run/${run.id}`} />}
      {done && (
        <Menu position="bottom-end">
          <Menu.Target>
            <Button variant="default">Export</Button>
          </Menu.Target>
          <Menu.Dropdown>
            <Menu.Item
              component="a"
              href={`/api/v1/runs/${run.id}/export`}
              download={`flexsid-run-${run.id}.json`}
            >
              Everything as JSON
            </Menu.Item>
            <Menu.Item
              component="a"
              href={`/api/v1/runs/${run.id}/notebook`}
              download={`flexsid-run-${run.id}.ipynb`}
            >
              Notebook (Jupyter)
            </Menu.Item>
            <Menu.Item
              component="a"
              href={`/api/v1/runs/${run.id}/capsule`}
              download={`flexsid-run-${run.id}.crate.zip`}
            >
              Capsule to recompute (RO-Crate)
            </Menu.Item>
            <Menu.Item
              component="a"
              href={`/api/v1/runs/${run.id}/model?format=mat`}
              download={`flexsid-model-${run.id}.mat`}
            >
              Model for MATLAB
            </Menu.Item>
            {(["2", "3"] as const).map((version) => (
              <Menu.Item
                key={version}
                component="a"
                href={`/api/v1/runs/${run.id}/fmu?fmi_version=${version}`}
                download={`flexsid-run-${run.id}.fmu`}
              >
                Model as FMU (FMI {version}.0)
              </Menu.Item>
            ))}
            <JsbsimItems run={run} />
            <Menu.Item
              onClick={() => {
                saveText(
                  csv([
                    ["name", "value", "std_error", "no_error", "start"],
                    ...run.parameters.map((one) => [
                      one.name,
                      one.value,
                      one.std_error,
                      one.no_error,
                      one.start,
                    ]),
                  ]),
                  `flexsid-run-${run.id}-parameters.csv`,
                );
              }}
            >
              Parameters as CSV
            </Menu.Item>
          </Menu.Dropdown>
        </Menu>
      )}
      {done && (
        <ButtonLink to="/compare" search={{ runs: [run.id], tab: "validation" }} variant="default">
          Validate
        </ButtonLink>
      )}
      {done && (
        <CompareLink
          runs={[{ id: run.id, prediction_id: run.prediction_id }, ...methods]}
          label={methods.length > 0 ? "Compare methods" : "Compare"}
        />
      )}
    </>
  );
}

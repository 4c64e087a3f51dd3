import { Select, Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { runsQuery } from "../api/queries";
import { byRole, excitedInputs } from "../lib/channels";
import { integers } from "../lib/urlState";
import { ChannelPicker } from "./ChannelPicker";
import { Empty } from "./Empty";
import { Figure } from "./Figure";
import type { ManeuverTabProps } from "./TimeHistoryTab";

/** Frequency responses from the excited inputs, with the models of runs drawn over them. */
export function BodeTab({ maneuver, view, onChange }: ManeuverTabProps) {
  const runs = useQuery(runsQuery({ maneuver_id: maneuver.id, state: "succeeded" }));
  const offered = excitedInputs(maneuver);
  const outputs = view.outputs ?? ["q"];
  const inputs = view.inputs ?? offered.slice(0, 3);
  return (
    <div className="split">
      <Stack gap="md">
        <Select
          label="Model"
          placeholder="Measured only"
          description="Succeeded run whose model is drawn over the measurement"
          clearable
          data-testid="bode-run"
          data={(runs.data ?? []).map((run) => ({
            value: String(run.id),
            label: `${run.method} run ${run.id}, modes ${run.structure.modes.join(" ")}`,
          }))}
          value={view.models?.[0] === undefined ? null : String(view.models[0])}
          onChange={(id) => {
            onChange({ models: integers(id) });
          }}
        />
        <ChannelPicker
          label="Inputs"
          groups={[{ label: "Excited", items: offered.map((name) => ({ name })) }]}
          value={inputs}
          onChange={(names) => {
            onChange({ inputs: names });
          }}
        />
        <ChannelPicker
          label="Outputs"
          groups={byRole(maneuver.channels, ["output"])}
          value={outputs}
          height={300}
          onChange={(names) => {
            onChange({ outputs: names });
          }}
        />
      </Stack>
      <div className="panel" style={{ padding: 12 }}>
        {outputs.length === 0 || inputs.length === 0 ? (
          <Empty title="Nothing to draw">Tick an input and an output on the left.</Empty>
        ) : (
          outputs.map((output) => (
            <Figure
              key={output}
              kind="bode"
              title={`${output} per input`}
              params={{ maneuver_id: maneuver.id, output, inputs, run_id: view.models?.[0] }}
              revision={`${output} ${inputs.join()}`}
            />
          ))
        )}
      </div>
    </div>
  );
}

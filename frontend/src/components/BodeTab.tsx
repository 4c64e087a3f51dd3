import { MultiSelect, Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { runsQuery } from "../api/queries";
import { excitedInputs } from "../lib/channels";
import { integers } from "../lib/urlState";
import { ChannelPicker } from "./ChannelPicker";
import { Empty } from "./Empty";
import { Figure } from "./Figure";
import { useOfferedChannels } from "./useOfferedChannels";
import type { ManeuverTabProps } from "./TimeHistoryTab";

/** Frequency responses from the excited inputs, with the models of runs drawn over them. */
export function BodeTab({ maneuver, view, onChange }: ManeuverTabProps) {
  const runs = useQuery(runsQuery({ maneuver_id: maneuver.id, state: "succeeded" }));
  const excited = excitedInputs(maneuver);
  const offered = useOfferedChannels(maneuver);
  const outputs = view.outputs ?? ["q"];
  const inputs = view.inputs ?? excited.slice(0, 3);
  return (
    <div className="split">
      <Stack gap="md">
        <MultiSelect
          label="Models"
          placeholder={view.models === undefined ? "Measured only" : undefined}
          description="Runs whose models are drawn over the measurement"
          clearable
          data-testid="bode-run"
          data={(runs.data ?? [])
            .filter((run) => run.method !== "EE" || run.poles.length > 0)
            .map((run) => ({
              value: String(run.id),
              label: `${run.method} run ${run.id}, modes ${run.structure.modes.join(" ")}`,
            }))}
          value={(view.models ?? []).map(String)}
          onChange={(ids) => {
            onChange({ models: integers(ids) });
          }}
        />
        <ChannelPicker
          label="Inputs"
          groups={[{ label: "Excited", items: excited.map((name) => ({ name })) }]}
          value={inputs}
          onChange={(names) => {
            onChange({ inputs: names });
          }}
        />
        <ChannelPicker
          label="Outputs"
          groups={offered(["output"])}
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
          <Figure
            kind="bode"
            title="Frequency responses of the bare airframe"
            params={{ maneuver_id: maneuver.id, output: outputs, inputs, run_id: view.models }}
            revision={[outputs, inputs].join("|")}
          />
        )}
      </div>
    </div>
  );
}

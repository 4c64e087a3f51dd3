import { Select, Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { maneuverQuery } from "../../api/queries";
import { overFrequency } from "../../lib/figures/band";
import { excitedInputs } from "../../lib/channels";
import type { CompareTabProps } from "./CompareDerivatives";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { Loaded } from "../display/Loaded";
import { Section } from "../display/Section";
import { WindowBar } from "../maneuvers/WindowBar";

const HINT = "Drag over a figure to select a band; responses and fits share it.";

function Band({ shared }: { shared: ReturnType<typeof overFrequency> }) {
  return (
    <WindowBar
      window={shared.window}
      unit="Hz"
      onClear={() => {
        shared.onWindow(null);
      }}
      hint={HINT}
      whole="Whole band"
    />
  );
}

/** Frequency responses of all maneuvers with the models of all runs overlaid. */
export function CompareResponses({ comparison, view, onChange }: CompareTabProps) {
  const [first, ...overlay] = comparison.maneuver_ids;
  const shared = overFrequency(view, onChange);
  const maneuver = useQuery({ ...maneuverQuery(first ?? 0), enabled: first !== undefined });
  return (
    <Loaded query={maneuver} rows={8}>
      {(flown) => {
        const outputs = flown.channels
          .filter((channel) => channel.role === "output")
          .map((channel) => channel.name);
        const output = outputs.find((one) => one === view.output) ?? outputs[0];
        if (output === undefined) return <Empty title={`${flown.label} has no outputs`} />;
        return (
          <Section
            title="Frequency responses"
            note={`Measured in ${comparison.maneuver_ids.length === 1 ? flown.label : "each maneuver"}, with the models of the runs`}
            actions={
              <Select
                aria-label="Output"
                searchable
                allowDeselect={false}
                w={140}
                data={outputs}
                value={output}
                onChange={(next) => {
                  onChange({ output: next ?? undefined });
                }}
              />
            }
          >
            <Band shared={shared} />
            <Figure
              {...shared}
              kind="bode"
              title={`${output}, measured and modelled`}
              params={{
                maneuver_id: flown.id,
                overlay,
                output,
                inputs: excitedInputs(flown).slice(0, 3),
                run_id: view.runs,
              }}
            />
          </Section>
        );
      }}
    </Loaded>
  );
}

/** Fit of each run, and the poles of all runs. */
export function ComparePoles({ comparison, view, onChange, onRun }: CompareTabProps) {
  const shared = overFrequency(view, onChange);
  const runs = comparison.sources.filter(
    (source) => source.run_id !== null && source.kind !== "prediction",
  );
  return (
    <Stack gap="md">
      <Section title="Poles" note="Of the identified models with ±2σ, and in vacuo">
        <Figure kind="poles" title="Poles" params={{ run_id: view.runs }} onPick={onRun} />
      </Section>
      <Section title="Fits" note="Measured and fitted data of the first outputs">
        <Band shared={shared} />
        <div className="fits">
          {runs.map((source) => (
            <Figure
              {...shared}
              key={source.key}
              kind="fit"
              title={source.label}
              params={{ run_id: source.run_id }}
            />
          ))}
        </div>
      </Section>
    </Stack>
  );
}

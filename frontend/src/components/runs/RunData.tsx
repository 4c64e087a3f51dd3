import { Group, MultiSelect, Select, Stack } from "@mantine/core";
import type { Maneuver, Prediction } from "../../api/types";
import { excitedInputs, named } from "../../lib/channels";
import { typedNumber } from "../../lib/text/format";
import { bandOf, STARTS, type RunDraft, type Start } from "../../lib/drafts/runDraft";
import { integer } from "../../lib/urlState";
import { NumberField } from "../controls/NumberField";
import { Section } from "../display/Section";

const START_NAMES: Record<Start, string> = {
  best: "Most likely candidate",
  "equation-error": "Equation error estimate",
  prediction: "Prediction",
  "residualized-prediction": "Residualized prediction",
  run: "Estimates of the earlier run",
};

interface Props {
  maneuver: Maneuver;
  outputs: string[];
  predictions: Prediction[];
  draft: RunDraft;
  /** Whether there is an earlier run whose estimates can be the start. */
  fromRun: boolean;
  onChange: (part: Partial<RunDraft>) => void;
}

/** Channels, band and initial values of the fit. */
export function RunData({ maneuver, outputs, predictions, draft, fromRun, onChange }: Props) {
  const inputs = draft.inputs.length > 0 ? draft.inputs : excitedInputs(maneuver);
  const band = bandOf(draft);
  return (
    <Section title="Data" note="Empty selection: all channels of the maneuver.">
      <Stack gap="sm">
        <MultiSelect
          label="Inputs"
          placeholder={draft.inputs.length === 0 ? inputs.join(", ") : undefined}
          searchable
          clearable
          data-testid="run-inputs"
          data={[
            ...new Set([
              ...draft.inputs,
              ...excitedInputs(maneuver),
              ...named(maneuver.channels, "input"),
            ]),
          ]}
          value={draft.inputs}
          onChange={(value) => {
            onChange({ inputs: value });
          }}
        />
        <MultiSelect
          label="Outputs"
          placeholder={draft.outputs.length === 0 ? "all suitable" : undefined}
          searchable
          clearable
          data-testid="run-outputs"
          data={outputs}
          value={draft.outputs}
          onChange={(value) => {
            onChange({ outputs: value });
          }}
        />
        <Group grow align="flex-start">
          {(["from", "to"] as const).map((end, index) => (
            <NumberField
              key={end}
              label={`Band ${end}`}
              unit="Hz"
              placeholder="excited band"
              hideControls
              error={"fault" in band}
              value={typedNumber(draft.band[index])}
              onChange={(value) => {
                const next: [string, string] = [...draft.band];
                next[index] = value === undefined ? "" : String(value);
                onChange({ band: next });
              }}
            />
          ))}
        </Group>
        <Group grow align="flex-start">
          <Select
            label="Start"
            description="Initial values of the iteration"
            allowDeselect={false}
            data-testid="run-start"
            data={STARTS.filter((start) => start !== "run" || fromRun).map((start) => ({
              value: start,
              label: START_NAMES[start],
            }))}
            value={draft.start}
            onChange={(start) => {
              onChange({ start: STARTS.find((one) => one === start) ?? "best" });
            }}
          />
          <Select
            label="Prediction"
            description="For initial values and priors"
            placeholder="default"
            clearable
            data={predictions.map((one) => ({ value: String(one.id), label: one.source }))}
            value={draft.prediction === null ? null : String(draft.prediction)}
            onChange={(id) => {
              onChange({ prediction: integer(id) ?? null });
            }}
          />
        </Group>
      </Stack>
    </Section>
  );
}

import { Checkbox, Select, Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { predictionsQuery } from "../../api/queries";
import { QUANTITIES } from "../../lib/limits";
import { integer } from "../../lib/urlState";
import { VARIABLES, type GlobalModelView } from "../../views";
import { RunChoice } from "../runs/RunChoice";

export const DEFAULT_VARIABLES = ["dynamic_pressure_pa", "fuel_fraction"] as const;

interface Props {
  view: GlobalModelView;
  onChange: (change: Partial<GlobalModelView>) => void;
}

/** Runs, variables and prediction of a global model. */
export function GlobalModelSettings({ view, onChange }: Props) {
  const predictions = useQuery(predictionsQuery());
  return (
    <Stack gap="md">
      <RunChoice
        description="Of one axis and the same modes"
        selected={view.runs ?? []}
        onChange={(runs) => {
          onChange({ runs });
        }}
        many
      />
      <Checkbox.Group
        label="Variables"
        value={[...(view.variables ?? DEFAULT_VARIABLES)]}
        onChange={(names) => {
          onChange({
            variables: VARIABLES.filter((one) => names.includes(one)),
            along: undefined,
            condition: undefined,
          });
        }}
      >
        <Stack gap={10} mt={6}>
          {QUANTITIES.map(({ key, label }) => (
            <Checkbox key={key} value={key} label={label} />
          ))}
        </Stack>
      </Checkbox.Group>
      <Select
        label="Prediction"
        description="Drawn beside; mean of the model where that predicts flights better"
        placeholder="None"
        clearable
        data={(predictions.data ?? []).map((one) => ({
          value: String(one.id),
          label: one.source,
        }))}
        value={view.prediction === undefined ? null : String(view.prediction)}
        onChange={(id) => {
          onChange({ prediction: integer(id ?? undefined) });
        }}
      />
    </Stack>
  );
}

import { Button, Checkbox, MultiSelect, Select, Stack } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { predictionsQuery, runListQuery } from "../../api/queries";
import { QUANTITIES } from "../../lib/limits";
import { integer, integers } from "../../lib/urlState";
import { VARIABLES, type GlobalModelView } from "../../views";

/** Runs of one request of the list. */
const MOST_OFFERED = 200;

export const DEFAULT_VARIABLES = ["dynamic_pressure_pa", "fuel_fraction"] as const;

interface Props {
  view: GlobalModelView;
  onChange: (change: Partial<GlobalModelView>) => void;
}

/** Runs, variables and prediction of a global model. */
export function GlobalModelSettings({ view, onChange }: Props) {
  const [typed, setTyped] = useState("");
  const [search] = useDebouncedValue(typed, 300);
  const runs = useInfiniteQuery(
    runListQuery({ state: "succeeded", search: search || undefined }, "-id", MOST_OFFERED),
  );
  const predictions = useQuery(predictionsQuery());
  const offered = (runs.data?.pages ?? [])
    .flatMap((page) => page.items)
    .map((run) => ({
      value: String(run.id),
      label: `${run.method} ${String(run.id)}: ${run.modes.join(" ") || "rigid"}, ${run.maneuver_label}`,
    }));
  const listed = new Set(offered.map((one) => one.value));
  const selected = (view.runs ?? []).map(String);
  const others = selected
    .filter((id) => !listed.has(id))
    .map((id) => ({ value: id, label: `Run ${id}` }));
  return (
    <Stack gap="md">
      <MultiSelect
        label="Runs"
        description="Of one axis and the same modes"
        searchable
        searchValue={typed}
        onSearchChange={setTyped}
        nothingFoundMessage="No succeeded run"
        clearable
        hidePickedOptions
        maxDropdownHeight={320}
        styles={{ pillsList: { maxHeight: 240, overflowY: "auto" } }}
        data-testid="global-model-runs"
        data={[...offered, ...others]}
        value={selected}
        onChange={(ids) => {
          onChange({ runs: integers(ids) });
        }}
      />
      {offered.some((one) => !selected.includes(one.value)) && (
        <Button
          variant="default"
          size="xs"
          onClick={() => {
            onChange({ runs: integers([...new Set([...selected, ...listed])]) });
          }}
        >
          Add {offered.filter((one) => !selected.includes(one.value)).length} listed runs
        </Button>
      )}
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

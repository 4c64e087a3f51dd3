import { Button, Checkbox, CloseButton, Group, Select, Stack, Text } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { useChangeMany } from "../../api/commands";
import { maneuversQuery, predictionsQuery, runListQuery, runsQuery } from "../../api/queries";
import type { Source } from "../../api/types";
import { integer } from "../../lib/urlState";
import type { CompareView } from "../../views";

interface Props {
  view: CompareView;
  sources: Source[];
  maneuverIds: number[];
  onChange: (change: Partial<CompareView>) => void;
}

const BASELINE = "baseline";

const without = (ids: number[] | undefined, id: number) => (ids ?? []).filter((one) => one !== id);

/** Selection of the compared sources: predictions, and runs of any maneuver. */
export function SourcePicker({ view, sources, maneuverIds, onChange }: Props) {
  const predictions = useQuery(predictionsQuery());
  const baselines = useInfiniteQuery(runListQuery({ tag: BASELINE, state: "succeeded" }, "-id"));
  const pinned = baselines.data?.pages.flatMap((page) => page.items) ?? [];
  const maneuver = view.maneuver ?? maneuverIds[0];
  const toggle = (key: "runs" | "predictions", id: number, on: boolean) => {
    onChange({ [key]: on ? [...(view[key] ?? []), id] : without(view[key], id) });
  };
  return (
    <div className="sources" data-testid="source-picker">
      <div>
        <Text size="sm" fw={600} mb={4}>
          Compared
        </Text>
        {sources.length === 0 && (
          <Text size="xs" className="quiet">
            None selected
          </Text>
        )}
        {sources.map((source) => (
          <Group key={source.key} justify="space-between" wrap="nowrap" gap={4}>
            <Text size="sm">{source.label}</Text>
            {source.run_id !== null && source.kind !== "prediction" && (
              <Pin runId={source.run_id} pinned={pinned.some((run) => run.id === source.run_id)} />
            )}
            {/* What belongs to both, a residualized prediction, goes with either. */}
            {(source.run_id === null || source.prediction_id === null) && (
              <CloseButton
                size="md"
                aria-label={`Remove ${source.label}`}
                onClick={() => {
                  if (source.run_id !== null) toggle("runs", source.run_id, false);
                  if (source.prediction_id !== null) {
                    toggle("predictions", source.prediction_id, false);
                  }
                }}
              />
            )}
          </Group>
        ))}
      </div>
      <Stack gap={8} role="group" aria-label="Predictions">
        <Text size="sm" fw={600}>
          Predictions
        </Text>
        {predictions.data?.length === 0 && (
          <Text size="xs" className="quiet">
            None stored
          </Text>
        )}
        {predictions.data?.map((one) => (
          <Checkbox
            key={one.id}
            label={one.source}
            checked={view.predictions?.includes(one.id) ?? false}
            data-testid={`prediction-${one.id}`}
            onChange={(event) => {
              toggle("predictions", one.id, event.currentTarget.checked);
            }}
          />
        ))}
      </Stack>
      {pinned.length > 0 && (
        <Stack gap={8} role="group" aria-label="Pinned baselines">
          <Text size="sm" fw={600}>
            Pinned baselines
          </Text>
          {pinned.map((run) => (
            <Checkbox
              key={run.id}
              label={`${run.method} run ${run.id}, ${run.maneuver_label}`}
              checked={view.runs?.includes(run.id) ?? false}
              data-testid={`pinned-${run.id}`}
              onChange={(event) => {
                toggle("runs", run.id, event.currentTarget.checked);
              }}
            />
          ))}
        </Stack>
      )}
      <Stack gap={8} role="group" aria-label="Runs">
        <ManeuverSelect
          value={maneuver}
          onChange={(id) => {
            onChange({ maneuver: id });
          }}
        />
        {maneuver !== undefined && (
          <RunsOf maneuver={maneuver} picked={view.runs ?? []} onToggle={toggle} />
        )}
      </Stack>
    </div>
  );
}

/** Pin of a run: offered in every comparison, and shown as a tag in the list of runs. */
function Pin({ runId, pinned }: { runId: number; pinned: boolean }) {
  const change = useChangeMany("runs");
  return (
    <Button
      variant="subtle"
      size="compact-sm"
      ml="auto"
      aria-pressed={pinned}
      aria-label={`Pin run ${runId} as baseline`}
      data-testid={`pin-${runId}`}
      onClick={() => {
        change.mutate({ ids: [runId], action: pinned ? "untag" : "tag", tag: BASELINE });
      }}
    >
      {pinned ? "Unpin" : "Pin"}
    </Button>
  );
}

interface RunsProps {
  maneuver: number;
  picked: number[];
  onToggle: (key: "runs", id: number, on: boolean) => void;
}

function RunsOf({ maneuver, picked, onToggle }: RunsProps) {
  const runs = useQuery(runsQuery({ maneuver_id: maneuver, state: "succeeded" }));
  if (runs.data?.length === 0) {
    return (
      <Text size="xs" className="quiet">
        No succeeded run of this maneuver
      </Text>
    );
  }
  return runs.data?.map((run) => (
    <Checkbox
      key={run.id}
      label={`${run.method} run ${run.id}, modes ${run.modes.join(" ") || "none"}`}
      checked={picked.includes(run.id)}
      data-testid={`source-run-${run.id}`}
      onChange={(event) => {
        onToggle("runs", run.id, event.currentTarget.checked);
      }}
    />
  ));
}

interface SelectProps {
  value: number | undefined;
  onChange: (id: number | undefined) => void;
}

/** Maneuvers are searched on the server: a campaign has more than a list can hold. */
function ManeuverSelect({ value, onChange }: SelectProps) {
  const [typed, setTyped] = useState("");
  const [search] = useDebouncedValue(typed, 300);
  const found = useInfiniteQuery(maneuversQuery({ search: search || undefined }, "label", 30));
  const options = (found.data?.pages ?? []).flatMap((page) =>
    page.items.map((one) => ({ value: String(one.id), label: one.label })),
  );
  const selected = value === undefined ? null : String(value);
  if (selected !== null && !options.some((option) => option.value === selected)) {
    options.push({ value: selected, label: `Maneuver ${selected}` });
  }
  return (
    <Select
      label="Runs of"
      placeholder="Select a maneuver"
      searchable
      data={options}
      value={selected}
      onSearchChange={(text) => {
        // Mantine also reports the selected label; that is not a search.
        setTyped(options.some((option) => option.label === text) ? "" : text);
      }}
      onChange={(id) => {
        onChange(integer(id));
      }}
    />
  );
}

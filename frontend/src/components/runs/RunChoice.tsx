import { Button, MultiSelect } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { useInfiniteQuery, useQueries } from "@tanstack/react-query";
import { useState } from "react";
import { runListQuery, runsQuery } from "../../api/queries";
import type { RunItem } from "../../api/types";
import { fixed } from "../../lib/text/format";
import { integers } from "../../lib/urlState";

/** Runs of one request of the list. */
const MOST_OFFERED = 200;

interface Props {
  description: string;
  selected: number[];
  onChange: (ids: number[] | undefined) => void;
  /** Whether all runs that the search lists can be added at once. */
  many?: boolean;
}

function describe(run: RunItem) {
  const ratio = run.airspeed_ratio;
  const at = ratio == null ? "" : `, ${fixed(ratio, 2)} V/Vf`;
  const modes = run.modes.join(" ") || "rigid";
  return {
    value: String(run.id),
    label: `${run.method} ${String(run.id)}: ${modes}, ${run.maneuver_label}${at}`,
  };
}

/** Choice of succeeded runs; they are searched on the server. */
export function RunChoice({ description, selected, onChange, many }: Props) {
  const [typed, setTyped] = useState("");
  const [search] = useDebouncedValue(typed, 300);
  const runs = useInfiniteQuery(
    runListQuery({ state: "succeeded", search: search || undefined }, "-id", MOST_OFFERED),
  );
  const offered = (runs.data?.pages ?? []).flatMap((page) => page.items).map(describe);
  const listed = offered.map((one) => one.value);
  const chosen = selected.map(String);
  // The search also finds the id of a run.
  const others = useQueries({
    queries: chosen.filter((id) => !listed.includes(id)).map((id) => runsQuery({ search: id })),
    combine: (found) => found.flatMap((one) => one.data ?? []).map(describe),
  });
  const labelled = [...offered, ...others].filter(
    (one, place, all) => all.findIndex((other) => other.value === one.value) === place,
  );
  const unknown = chosen.filter((id) => labelled.every((one) => one.value !== id));
  const further = listed.filter((id) => !chosen.includes(id));
  return (
    <>
      <MultiSelect
        label="Runs"
        description={description}
        searchable
        searchValue={typed}
        onSearchChange={setTyped}
        nothingFoundMessage="No succeeded run"
        clearable
        hidePickedOptions
        maxDropdownHeight={320}
        styles={{ pillsList: { maxHeight: 240, overflowY: "auto" } }}
        data-testid="run-choice"
        data={[
          ...labelled.filter((one) => listed.includes(one.value) || chosen.includes(one.value)),
          ...unknown.map((id) => ({ value: id, label: `Run ${id}` })),
        ]}
        value={chosen}
        onChange={(ids) => {
          onChange(integers(ids));
        }}
      />
      {many === true && further.length > 0 && (
        <Button
          variant="default"
          size="xs"
          onClick={() => {
            onChange(integers([...chosen, ...further]));
          }}
        >
          Add {further.length} listed runs
        </Button>
      )}
    </>
  );
}

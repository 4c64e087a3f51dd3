import { Button, MultiSelect } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { useInfiniteQuery } from "@tanstack/react-query";
import { useState } from "react";
import { runListQuery } from "../../api/queries";
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

/** Choice of succeeded runs; they are searched on the server. */
export function RunChoice({ description, selected, onChange, many }: Props) {
  const [typed, setTyped] = useState("");
  const [search] = useDebouncedValue(typed, 300);
  const runs = useInfiniteQuery(
    runListQuery({ state: "succeeded", search: search || undefined }, "-id", MOST_OFFERED),
  );
  const offered = (runs.data?.pages ?? [])
    .flatMap((page) => page.items)
    .map((run) => {
      const ratio = run.airspeed_ratio;
      const at = ratio == null ? "" : `, ${fixed(ratio, 2)} V/Vf`;
      return {
        value: String(run.id),
        label: `${run.method} ${String(run.id)}: ${run.modes.join(" ") || "rigid"}, ${run.maneuver_label}${at}`,
      };
    });
  const listed = offered.map((one) => one.value);
  const chosen = selected.map(String);
  const others = chosen
    .filter((id) => !listed.includes(id))
    .map((id) => ({ value: id, label: `Run ${id}` }));
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
        data={[...offered, ...others]}
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

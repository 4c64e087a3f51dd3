import { Select } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { useInfiniteQuery } from "@tanstack/react-query";
import { useState } from "react";
import { maneuversQuery } from "../../api/queries";
import { integer } from "../../lib/urlState";

interface Props {
  label: string;
  placeholder: string;
  disabled?: boolean;
  onChoose: (id: number) => void;
}

/** Finds one maneuver by the words of its label. */
export function ManeuverSelect({ label, placeholder, disabled, onChoose }: Props) {
  const [typed, setTyped] = useState("");
  const [search] = useDebouncedValue(typed, 200);
  const maneuvers = useInfiniteQuery(maneuversQuery(search === "" ? {} : { search }, "id", 50));
  const items = maneuvers.data?.pages.flatMap((page) => page.items) ?? [];
  return (
    <Select
      aria-label={label}
      placeholder={placeholder}
      disabled={disabled}
      searchable
      searchValue={typed}
      onSearchChange={setTyped}
      filter={({ options }) => options} // the server has searched
      nothingFoundMessage="No matching maneuver"
      value={null}
      data={items.map((one) => ({ value: String(one.id), label: one.label }))}
      onChange={(value) => {
        const id = integer(value);
        if (id !== undefined) onChoose(id);
      }}
    />
  );
}

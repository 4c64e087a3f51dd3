import { Checkbox } from "@mantine/core";
import type { Column } from "./DataTable";

/** Ticks in front of lines, with one above them for all that are shown. */
export function selectColumn<Row extends { id: number }>(
  rows: readonly Row[],
  selected: readonly number[],
  onSelect: (ids: number[]) => void,
  name: (row: Row) => string,
): Column<Row> {
  const every = rows.length > 0 && rows.every((one) => selected.includes(one.id));
  return {
    key: "select",
    header: (
      <Checkbox
        aria-label="Select all shown"
        checked={every}
        indeterminate={!every && rows.some((one) => selected.includes(one.id))}
        onChange={() => {
          onSelect(every ? [] : rows.map((one) => one.id));
        }}
      />
    ),
    render: (one) => (
      <Checkbox
        aria-label={`Select ${name(one)}`}
        checked={selected.includes(one.id)}
        onChange={(event) => {
          onSelect(
            event.currentTarget.checked
              ? [...selected, one.id]
              : selected.filter((id) => id !== one.id),
          );
        }}
      />
    ),
  };
}

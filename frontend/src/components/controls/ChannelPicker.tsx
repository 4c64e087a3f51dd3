import { Button, Checkbox, Group, ScrollArea, Stack, Text, TextInput } from "@mantine/core";
import { useState } from "react";
import { SearchIcon } from "../display/icons";

interface PickerGroup {
  label: string;
  items: { name: string; note?: string }[];
}

interface Props {
  label: string;
  groups: PickerGroup[];
  value: string[];
  onChange: (names: string[]) => void;
  height?: number | string;
}

/** Selection of names in groups; a search filters the list, not the selection. */
export function ChannelPicker({ label, groups, value, onChange, height = 440 }: Props) {
  const [search, setSearch] = useState("");
  const query = search.trim().toLowerCase();
  const shown = groups
    .map((group) => ({
      ...group,
      items: group.items.filter((item) => item.name.toLowerCase().includes(query)),
    }))
    .filter((group) => group.items.length > 0);
  const order = groups.flatMap((group) => group.items.map((item) => item.name));
  const set = (names: Set<string>) => {
    onChange(order.filter((name) => names.has(name)));
  };

  return (
    <Stack gap="xs" component="fieldset" m={0} p={0} bd={0} data-testid="channel-picker">
      <Text component="legend" size="sm" fw={600} mb={4}>
        {label}
      </Text>
      <TextInput
        placeholder="Find"
        aria-label={`Find in ${label.toLowerCase()}`}
        leftSection={<SearchIcon size={12} />}
        value={search}
        onChange={(event) => {
          setSearch(event.currentTarget.value);
        }}
      />
      <ScrollArea.Autosize mah={height} type="auto" offsetScrollbars>
        <Stack gap="sm">
          {shown.map((group) => {
            const names = group.items.map((item) => item.name);
            const all = names.every((name) => value.includes(name));
            return (
              <Stack gap={8} key={group.label} role="group" aria-label={group.label}>
                <Group justify="space-between" gap="xs">
                  <Text size="xs" className="quiet">
                    {group.label}
                  </Text>
                  <Button
                    variant="subtle"
                    size="compact-xs"
                    aria-label={`${all ? "Clear" : "Select"} all ${group.label.toLowerCase()}`}
                    onClick={() => {
                      const next = new Set(value);
                      for (const name of names) {
                        if (all) next.delete(name);
                        else next.add(name);
                      }
                      set(next);
                    }}
                  >
                    {all ? "none" : "all"}
                  </Button>
                </Group>
                {group.items.map((item) => (
                  <Checkbox
                    key={item.name}
                    label={
                      <>
                        {item.name}{" "}
                        {item.note !== undefined && <span className="unit">{item.note}</span>}
                      </>
                    }
                    checked={value.includes(item.name)}
                    onChange={(event) => {
                      const next = new Set(value);
                      if (event.currentTarget.checked) next.add(item.name);
                      else next.delete(item.name);
                      set(next);
                    }}
                  />
                ))}
              </Stack>
            );
          })}
        </Stack>
      </ScrollArea.Autosize>
    </Stack>
  );
}

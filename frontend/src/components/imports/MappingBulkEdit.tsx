import { Button, Group, NativeSelect, Text, TextInput } from "@mantine/core";
import { useState } from "react";
import type { CheckedMapping } from "../../api/types";
import { matchRules, setKey } from "../../lib/text/mappingText";

interface Props {
  checked: CheckedMapping;
  text: string;
  onChange: (text: string) => void;
}

/** Edits of all channels whose column or name matches a regular expression. */
export function MappingBulkEdit({ checked, text, onChange }: Props) {
  const [pattern, setPattern] = useState("");
  const [replacement, setReplacement] = useState("");
  const [unit, setUnit] = useState("");
  const matched = pattern === "" ? [] : matchRules(checked.rules, pattern);
  const setAll = (key: string, value: (nth: number) => string | undefined) => {
    onChange(
      (matched ?? []).reduce((edited, nth) => {
        const next = value(nth);
        return next === undefined || next === ""
          ? edited
          : setKey(edited, "channels", nth, key, next);
      }, text),
    );
  };
  const none = matched === undefined || matched.length === 0;
  return (
    <Group gap="sm" align="end" data-testid="mapping-bulk">
      <TextInput
        size="xs"
        w={170}
        label="Channels matching"
        placeholder="^AZ_W(\d+)"
        value={pattern}
        error={matched === undefined}
        onChange={(event) => {
          setPattern(event.currentTarget.value);
        }}
      />
      <Text size="xs" className="quiet numbers" w={70} pb={6} role="status">
        {matched === undefined ? "not a pattern" : `${matched.length} found`}
      </Text>
      <Group gap={4} align="end" wrap="nowrap">
        <TextInput
          size="xs"
          w={130}
          label="Replace by"
          placeholder="az_w$1"
          value={replacement}
          onChange={(event) => {
            setReplacement(event.currentTarget.value);
          }}
        />
        <Button
          size="xs"
          variant="default"
          disabled={none || replacement === ""}
          onClick={() => {
            const expression = new RegExp(pattern, "i");
            setAll("name", (nth) => {
              const rule = checked.rules[nth];
              const name = rule?.["name"] ?? rule?.["column"];
              return typeof name === "string" ? name.replace(expression, replacement) : undefined;
            });
          }}
        >
          Replace
        </Button>
      </Group>
      <Group gap={4} align="end" wrap="nowrap">
        <TextInput
          size="xs"
          w={80}
          label="Unit"
          value={unit}
          onChange={(event) => {
            setUnit(event.currentTarget.value);
          }}
        />
        <Button
          size="xs"
          variant="default"
          disabled={none || unit === ""}
          onClick={() => {
            setAll("unit", () => unit);
          }}
        >
          Set unit
        </Button>
      </Group>
      <NativeSelect
        size="xs"
        label="Role"
        disabled={none}
        data={[{ value: "", label: "set role" }, "input", "output", "command", "condition"]}
        value=""
        onChange={(event) => {
          const role = event.currentTarget.value;
          setAll("role", () => role);
        }}
      />
    </Group>
  );
}

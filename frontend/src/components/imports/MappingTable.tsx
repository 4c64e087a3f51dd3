import { ActionIcon, Autocomplete, Box, Checkbox, NativeSelect, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { aircraftQuery } from "../../api/queries";
import type { CheckedMapping } from "../../api/types";
import {
  countTables,
  guessedKeys,
  readKey,
  removeTable,
  setKey,
  setUnit,
} from "../../lib/text/mappingText";
import { DataTable, numeric, type Column } from "../controls/DataTable";

interface Props {
  checked: CheckedMapping;
  text: string;
  /** The text is the one that was checked. */
  current: boolean;
  onChange: (text: string) => void;
  /** Channels that are drawn. */
  shown: string[];
  onShow: (names: string[]) => void;
}

type Row = { nth: number; rule: Record<string, unknown> };

const ROLES = ["input", "output", "command", "condition"];

const word = (value: unknown) =>
  typeof value === "string" || typeof value === "number" ? String(value) : "";

/** The channels of a mapping, one row each. */
export function MappingTable({ checked, text, current, onChange, shown, onShow }: Props) {
  const rows: Row[] = checked.rules.map((rule, nth) => ({ nth, rule }));
  const flagged = new Set(checked.queries.map((one) => one.channel));
  const name = ({ rule }: Row) => word(rule["name"]) || word(rule["column"]);
  // While it is typed, a value is ahead of its check.
  const read = ({ nth, rule }: Row, key: string) =>
    current ? rule[key] : readKey(text, "channels", key, nth);
  const made = (row: Row) => checked.channels.find((channel) => channel.name === name(row));
  const guessed = (row: Row, key: string) =>
    guessedKeys(text, "channels", row.nth).includes(key) ? "guessed" : undefined;
  const set = (row: Row, key: string, value: string | number | undefined) => {
    onChange(setKey(text, "channels", row.nth, key, value));
  };
  const roles = useOwnNames(text);
  const taken = new Set(checked.rules.map((rule) => rule["name"]));
  const free = [...roles.keys()].filter((own) => !taken.has(own));
  // The name of a surface, a command or a sensor of the aircraft states the role.
  const rename = ({ nth }: Row, value: string) => {
    const named = setKey(text, "channels", nth, "name", value);
    const role = roles.get(value);
    onChange(role === undefined ? named : setKey(named, "channels", nth, "role", role));
  };

  const columns: Column<Row>[] = [
    {
      key: "show",
      header: "Draw",
      render: (row) => (
        <Checkbox
          size="xs"
          aria-label={`Draw ${name(row)}`}
          disabled={made(row) === undefined}
          checked={shown.includes(name(row))}
          onChange={(event) => {
            const others = shown.filter((own) => own !== name(row));
            onShow(event.currentTarget.checked ? [...others, name(row)] : others);
          }}
        />
      ),
    },
    {
      key: "column",
      header: "Column",
      render: ({ rule }) =>
        rule["array"] === undefined
          ? [word(rule["column"]), ...otherSide(rule)].join(", ")
          : `${word(rule["array"])}${rule["labels"] === undefined ? `(${word(rule["column"])})` : ", all columns"}`,
    },
    {
      key: "name",
      header: "Channel",
      render: (row) => (
        <Autocomplete
          size="xs"
          aria-label={`Name of ${word(row.rule["column"])}`}
          data={free}
          limit={200}
          description={guessed(row, "name")}
          inputWrapperOrder={["input", "description"]}
          value={word(read(row, "name") ?? row.rule["column"])}
          onChange={(value) => {
            rename(row, value);
          }}
        />
      ),
    },
    {
      key: "unit",
      header: "Unit",
      render: (row) =>
        typeof row.rule["unit"] === "object" ? (
          "several"
        ) : (
          <TextInput
            size="xs"
            w={90}
            aria-label={`Unit of ${name(row)}`}
            error={flagged.has(name(row))}
            description={guessed(row, "unit")}
            inputWrapperOrder={["input", "description"]}
            value={word(read(row, "unit"))}
            onChange={(event) => {
              const unit = event.currentTarget.value;
              onChange(setUnit(text, row.nth, word(row.rule["column"]), unit));
            }}
          />
        ),
    },
    {
      key: "role",
      header: "Role",
      render: (row) => (
        <NativeSelect
          size="xs"
          aria-label={`Role of ${name(row)}`}
          data={ROLES}
          description={guessed(row, "role")}
          inputWrapperOrder={["input", "description"]}
          value={word(read(row, "role"))}
          onChange={(event) => {
            set(row, "role", event.currentTarget.value);
          }}
        />
      ),
    },
    {
      key: "sign",
      header: "Sign",
      render: (row) => (
        <NativeSelect
          size="xs"
          aria-label={`Sign of ${name(row)}`}
          data={[
            { value: "1", label: "+" },
            { value: "-1", label: "−" },
          ]}
          value={word(read(row, "sign")) === "-1" ? "-1" : "1"}
          onChange={(event) => {
            set(row, "sign", event.currentTarget.value === "-1" ? -1 : undefined);
          }}
        />
      ),
    },
    {
      key: "sensor",
      header: "Sensor",
      render: (row) => (
        <TextInput
          size="xs"
          w={100}
          aria-label={`Sensor of ${name(row)}`}
          value={word(read(row, "sensor"))}
          onChange={(event) => {
            set(row, "sensor", event.currentTarget.value || undefined);
          }}
        />
      ),
    },
    numeric("rate", "Rate", (row) => made(row)?.rate_hz.toPrecision(4) ?? "", "Hz"),
    {
      key: "range",
      header: "From … to",
      numeric: true,
      render: (row) => {
        const channel = made(row);
        return channel === undefined
          ? ""
          : `${channel.smallest.toPrecision(3)} … ${channel.largest.toPrecision(3)}`;
      },
    },
    {
      key: "remove",
      header: "",
      render: (row) => (
        <ActionIcon
          variant="subtle"
          color="gray"
          size="sm"
          aria-label={`Exclude ${name(row)}`}
          onClick={() => {
            onChange(removeTable(text, "channels", row.nth));
          }}
        >
          ×
        </ActionIcon>
      ),
    },
  ];
  return (
    // After a channel was taken out, rows and tables correspond again once checked.
    <Box
      component="fieldset"
      m={0}
      p={0}
      bd={0}
      disabled={countTables(text, "channels") !== rows.length}
    >
      <DataTable
        columns={columns}
        rows={rows}
        rowKey={(row) => row.nth}
        label="Channels of the mapping"
        testId="mapping-table"
        maxHeight={460}
      />
    </Box>
  );
}

/** Columns of the other side, whose mean with the first is taken. */
function otherSide(rule: Record<string, unknown>): string[] {
  const side = rule["other_side"];
  return typeof side === "object" && side !== null && "column" in side ? [word(side.column)] : [];
}

/** Names of the surfaces, commands and sensors of the aircraft of a mapping, with their roles. */
function useOwnNames(text: string): Map<string, string> {
  const { data } = useQuery(aircraftQuery);
  const named = readKey(text, "aircraft", "builtin") ?? readKey(text, "aircraft", "name");
  const own = data?.find((one) => one.name === named);
  return new Map([
    ...(own?.surfaces ?? []).map((one): [string, string] => [one.name, "input"]),
    ...(own?.sensors ?? []).map((one): [string, string] => [one.name, "output"]),
    ...(own?.surfaces ?? []).map((one): [string, string] => [`${one.name}_command`, "command"]),
  ]);
}

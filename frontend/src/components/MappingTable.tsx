import { ActionIcon, Checkbox, NativeSelect, TextInput } from "@mantine/core";
import type { CheckedMapping } from "../api/types";
import { guessedKeys, removeTable, setKey } from "../lib/mappingText";
import { DataTable, numeric, type Column } from "./DataTable";

interface Props {
  checked: CheckedMapping;
  text: string;
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
export function MappingTable({ checked, text, onChange, shown, onShow }: Props) {
  const rows: Row[] = checked.rules.map((rule, nth) => ({ nth, rule }));
  const flagged = new Set(checked.queries.map((one) => one.channel));
  const name = ({ rule }: Row) => word(rule["name"]) || word(rule["column"]);
  const made = (row: Row) => checked.channels.find((channel) => channel.name === name(row));
  const guessed = (row: Row, key: string) =>
    guessedKeys(text, "channels", row.nth).includes(key) ? "guessed" : undefined;
  const set = (row: Row, key: string, value: string | number | undefined) => {
    onChange(setKey(text, "channels", row.nth, key, value));
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
          ? word(rule["column"])
          : `${word(rule["array"])}${rule["labels"] === undefined ? `(${word(rule["column"])})` : ", all columns"}`,
    },
    {
      key: "name",
      header: "Channel",
      render: (row) => (
        <TextInput
          size="xs"
          aria-label={`Name of ${word(row.rule["column"])}`}
          value={word(row.rule["name"]) || word(row.rule["column"])}
          onChange={(event) => {
            set(row, "name", event.currentTarget.value);
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
            value={word(row.rule["unit"])}
            onChange={(event) => {
              set(row, "unit", event.currentTarget.value);
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
          value={word(row.rule["role"])}
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
          value={row.rule["sign"] === -1 ? "-1" : "1"}
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
          value={word(row.rule["sensor"])}
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
    <DataTable
      columns={columns}
      rows={rows}
      rowKey={(row) => row.nth}
      label="Channels of the mapping"
      testId="mapping-table"
      maxHeight={460}
    />
  );
}

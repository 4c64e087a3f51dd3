import {
  Autocomplete,
  Checkbox,
  Group,
  MultiSelect,
  NativeSelect,
  SegmentedControl,
  Stack,
  TextInput,
} from "@mantine/core";
import type { UploadDetail } from "../../api/types";
import {
  readKey,
  readList,
  readQuantity,
  removeTable,
  setKey,
  setManeuver,
  setToml,
  writeQuantity,
} from "../../lib/text/mappingText";

interface Props {
  text: string;
  onChange: (text: string) => void;
  found: UploadDetail;
}

const TIME_UNITS = ["s", "ms", "us", "ns", "min"];
const REPAIRS = [
  { value: "single-nan", label: "single missing samples" },
  { value: "repeated-stamps", label: "repeated time stamps" },
  { value: "exchanged-stamps", label: "exchanged time stamps" },
  { value: "midnight", label: "clock that begins anew at midnight" },
  { value: "gps-week", label: "clock that begins anew with the GPS week" },
];
const OF_FILES = "clocks in the files"; // no column has this name
const CONDITION = "maneuver.condition";
const QUANTITIES = [
  { key: "airspeed", label: "Airspeed", unit: "m/s" },
  { key: "altitude", label: "Altitude", unit: "m" },
  { key: "density", label: "Density", unit: "kg/m3" },
  { key: "fuel_fraction", label: "Fuel", unit: "%" },
] as const;

/** Time base, flight condition (from columns of the files, or as numbers), and what is repaired. */
export function MappingClock({ text, onChange, found }: Props) {
  const fields = [...new Set(found.fields.map((one) => one.field))];
  const isManeuver = /^\s*\[maneuver\]/m.test(text);
  return (
    <Stack gap="xs">
      <Time text={text} onChange={onChange} fields={fields} />
      <Group gap="sm" align="end">
        <SegmentedControl
          size="xs"
          aria-label="Contents of the files"
          data={[
            { value: "maneuver", label: "One maneuver" },
            { value: "flight", label: "Whole flight" },
          ]}
          value={isManeuver ? "maneuver" : "flight"}
          onChange={(value) => {
            onChange(setManeuver(text, value === "maneuver"));
          }}
        />
        {isManeuver &&
          QUANTITIES.filter(({ key }) => isShown(text, key)).map(({ key, label, unit }) => {
            const quantity = readQuantity(text, CONDITION, key);
            const write = (given: string, symbol: string) => {
              onChange(
                setToml(
                  text,
                  CONDITION,
                  0,
                  key,
                  given === "" ? undefined : writeQuantity(given, symbol),
                ),
              );
            };
            return (
              <Group key={key} gap={4} align="end" wrap="nowrap">
                <Autocomplete
                  size="xs"
                  w={130}
                  label={label}
                  placeholder="column or number"
                  data={fields}
                  value={quantity?.given ?? ""}
                  onChange={(given) => {
                    write(given, quantity?.unit ?? unit);
                  }}
                />
                <TextInput
                  size="xs"
                  w={64}
                  aria-label={`Unit of ${label}`}
                  value={quantity?.unit ?? unit}
                  disabled={quantity === undefined}
                  onChange={(event) => {
                    write(quantity?.given ?? "", event.currentTarget.value);
                  }}
                />
              </Group>
            );
          })}
        <MultiSelect
          size="xs"
          miw={180}
          label="Repair"
          placeholder="nothing"
          data={REPAIRS}
          value={readList(text, "", 0, "repair")}
          onChange={(steps) => {
            onChange(setKey(text, "", 0, "repair", steps.length > 0 ? steps : undefined));
          }}
          data-testid="mapping-repair"
        />
      </Group>
    </Stack>
  );
}

/** Altitude or density gives the condition; both are never needed. */
function isShown(text: string, key: string): boolean {
  const other = { altitude: "density", density: "altitude" }[key];
  if (other === undefined || readQuantity(text, CONDITION, key) !== undefined) return true;
  return key === "altitude" && readQuantity(text, CONDITION, other) === undefined;
}

function Time({ text, onChange, fields }: Omit<Props, "found"> & { fields: string[] }) {
  const column = readKey(text, "time", "column");
  const isListed = column === undefined || fields.includes(column);
  const start = readKey(text, "time", "start") ?? "";
  const rate = readQuantity(text, "time", "rate")?.given ?? "";
  const hasOwnClocks = column === undefined && rate === "";
  const restart = (lines: string) => {
    onChange(`[time]\n${lines}\n\n${removeTable(text, "time", 0)}`);
  };
  return (
    <Group gap="sm" align="end">
      <NativeSelect
        size="xs"
        w={200}
        label="Time"
        data={[
          ...(hasOwnClocks ? [{ value: OF_FILES, label: "clocks in the files" }] : []),
          { value: "", label: "sampling rate" },
          ...(isListed ? fields : [column, ...fields]).map((one) => ({
            value: one,
            label: `column ${one}`,
          })),
        ]}
        value={column ?? (hasOwnClocks ? OF_FILES : "")}
        onChange={(event) => {
          const selected = event.currentTarget.value;
          if (selected === OF_FILES) return;
          restart(
            selected === ""
              ? `rate = ${writeQuantity("100", "Hz")}\nguessed = ["rate"]`
              : `column = ${JSON.stringify(selected)}\nunit = "s"\nguessed = ["unit"]`,
          );
        }}
      />
      {column === undefined && !hasOwnClocks && (
        <>
          <TextInput
            size="xs"
            w={110}
            label="Rate [Hz]"
            inputMode="decimal"
            defaultValue={rate}
            key={`rate ${rate}`}
            onBlur={(event) => {
              const value = event.currentTarget.value;
              if (Number(value) > 0 && value !== rate) {
                onChange(setToml(text, "time", 0, "rate", writeQuantity(value, "Hz")));
              }
            }}
          />
          <TextInput
            size="xs"
            w={110}
            label="Start [s]"
            inputMode="decimal"
            placeholder="0"
            defaultValue={start}
            key={`start ${start}`}
            onBlur={(event) => {
              const value = event.currentTarget.value.trim();
              if (Number.isFinite(Number(value)) && value !== start) {
                onChange(
                  setKey(text, "time", 0, "start", value === "" ? undefined : Number(value)),
                );
              }
            }}
          />
        </>
      )}
      {column !== undefined && (
        <NativeSelect
          size="xs"
          label="Unit of time"
          data={TIME_UNITS}
          value={readKey(text, "time", "unit") ?? "s"}
          onChange={(event) => {
            onChange(setKey(text, "time", 0, "unit", event.currentTarget.value));
          }}
        />
      )}
      {(column !== undefined || hasOwnClocks) && (
        <Checkbox
          size="xs"
          mb={6}
          label="Interpolate uneven samples"
          checked={readKey(text, "time", "uneven") === "interpolate"}
          onChange={(event) => {
            const isLast = hasOwnClocks && !event.currentTarget.checked;
            onChange(
              isLast
                ? removeTable(text, "time", 0)
                : setKey(
                    text,
                    "time",
                    0,
                    "uneven",
                    event.currentTarget.checked ? "interpolate" : undefined,
                  ),
            );
          }}
        />
      )}
    </Group>
  );
}

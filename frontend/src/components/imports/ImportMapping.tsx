import {
  Alert,
  Autocomplete,
  Button,
  Group,
  List,
  SegmentedControl,
  Select,
  Stack,
  Text,
  Textarea,
  TextInput,
} from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { getRouteApi } from "@tanstack/react-router";
import { useEffect, useRef, useState } from "react";
import { useSaveDraft, useSaveMapping } from "../../api/commands";
import { aircraftQuery, mappingCheckQuery, mappingsQuery, uploadQuery } from "../../api/queries";
import type { CheckedMapping, UnitWarning, UploadDetail } from "../../api/types";
import { guessedKeys, readKey, removeTable, setKey } from "../../lib/text/mappingText";
import { useUndo } from "../../lib/drafts/useUndo";
import { IMPORT_FORMS } from "../../views";
import { FoundFields } from "./FoundFields";
import { ImportProgress } from "./ImportProgress";
import { MappingBulkEdit } from "./MappingBulkEdit";
import { MappingClock } from "./MappingClock";
import { MappingGuesses } from "./MappingGuesses";
import { MappingPreview } from "./MappingPreview";
import { MappingTable } from "./MappingTable";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";

const route = getRouteApi("/import");

/** Mapping of an upload: proposal, editor, check, preview and import. */
export function ImportMapping({ found }: { found: UploadDetail }) {
  const { form = "table", channels = [] } = route.useSearch();
  const navigate = route.useNavigate();
  const id = found.upload.id;
  const [text, store] = useState(found.draft ?? found.proposal.text);
  const { set: setText, undo, redo, canUndo, canRedo } = useUndo(text, store);
  const [settled] = useDebouncedValue(text, 300);
  const saving = useStoredDraft(id, settled, found.draft ?? found.proposal.text);
  const check = useQuery(mappingCheckQuery(id, settled));
  const checked = check.data;
  const current = settled === text && !check.isPlaceholderData;
  // Meanwhile the check is that of the mapping before; one that has not passed has no preview.
  const passed = checked?.problem === null && !check.isPlaceholderData ? settled : undefined;
  const [previewed, setPreviewed] = useState(passed);
  if (passed !== undefined && passed !== previewed) setPreviewed(passed);
  const fine =
    current &&
    checked?.problem === null &&
    checked.queries.length === 0 &&
    checked.guesses.length === 0;

  return (
    <Stack gap="md">
      <FoundFields found={found} />
      <Section
        title="Mapping"
        note={`Proposed from ${found.proposal.origin}. It assigns each column; ${saving.isPending ? "edits are being stored" : "edits are stored on the server"}.`}
        actions={
          <Group gap="xs">
            <Button size="xs" variant="default" disabled={!canUndo} onClick={undo}>
              Undo
            </Button>
            <Button size="xs" variant="default" disabled={!canRedo} onClick={redo}>
              Redo
            </Button>
            <SegmentedControl
              size="xs"
              aria-label="Edit the mapping as"
              value={form}
              onChange={(value) =>
                void navigate({
                  search: (old) => ({ ...old, form: IMPORT_FORMS.find((own) => own === value) }),
                  replace: true,
                })
              }
              data={[
                { value: "table", label: "Table" },
                { value: "toml", label: "TOML" },
              ]}
            />
          </Group>
        }
      >
        <Stack gap="sm">
          <Belongings text={text} onChange={setText} found={found} />
          {form === "table" && <MappingClock text={text} onChange={setText} found={found} />}
          {form === "table" && checked !== undefined && (
            <MappingBulkEdit checked={checked} text={text} onChange={setText} />
          )}
          {form === "toml" ? (
            <Textarea
              aria-label="Mapping as TOML"
              data-testid="mapping-toml"
              autosize
              minRows={12}
              maxRows={36}
              spellCheck={false}
              styles={{ input: { fontFamily: "var(--mantine-font-family-monospace)" } }}
              value={text}
              onChange={(event) => {
                setText(event.currentTarget.value);
              }}
            />
          ) : (
            checked !== undefined && (
              <MappingTable
                checked={checked}
                text={text}
                current={current}
                onChange={setText}
                shown={channels}
                onShow={(names) =>
                  void navigate({
                    search: (old) => ({ ...old, channels: names }),
                    replace: true,
                  })
                }
              />
            )
          )}
          {saving.isError && <ProblemAlert error={saving.error} />}
          {check.isError && <ProblemAlert error={check.error} />}
          {checked !== undefined && <Remarks checked={checked} text={text} onChange={setText} />}
          {checked !== undefined && checked.guesses.length > 0 && (
            <MappingGuesses guesses={checked.guesses} text={text} onChange={setText} />
          )}
        </Stack>
      </Section>
      {checked?.problem === null && checked.channels.length > 0 && previewed !== undefined && (
        <MappingPreview id={id} mapping={previewed} channels={channels} />
      )}
      <Group justify="space-between" align="end">
        <SaveMapping text={text} usable={current && checked?.problem === null} />
        <ImportProgress id={id} text={text} ready={fine} />
      </Group>
    </Stack>
  );
}

/** Stores the mapping on the server after each change, for a reload and other browsers. */
function useStoredDraft(id: string, text: string, known: string) {
  const save = useSaveDraft();
  const { mutate } = save;
  const stored = useRef(known);
  useEffect(() => {
    if (text === stored.current) return;
    stored.current = text;
    mutate({ id, mapping: text });
  }, [id, text, mutate]);
  return save;
}

interface Edit {
  text: string;
  onChange: (text: string) => void;
}

/** A mapping without its aircraft and flight. */
const columnsOf = (text: string) => removeTable(removeTable(text, "aircraft", 0), "flight", 0);

/** Aircraft, flight and label of the maneuver. */
function Belongings({ text, onChange, found }: Edit & { found: UploadDetail }) {
  const aircraft = useQuery(aircraftQuery);
  const cache = useQueryClient();
  const mappings = useQuery(mappingsQuery);
  const saved = mappings.data ?? [];
  const builtin = readKey(text, "aircraft", "builtin");
  const proposed = useRef(new Set([columnsOf(found.proposal.text)]));
  // Columns are named as the surfaces and sensors of the aircraft; what was edited remains.
  const propose = async (name: string) => {
    if (!proposed.current.has(columnsOf(text))) return;
    const { proposal } = await cache.query(uploadQuery(found.upload.id, name));
    proposed.current.add(columnsOf(proposal.text));
    const named = setKey(proposal.text, "aircraft", 0, "name", name);
    const number = readKey(text, "flight", "number");
    const isOpen = guessedKeys(text, "flight", 0).includes("number");
    onChange(isOpen ? named : setKey(named, "flight", 0, "number", Number(number)));
  };
  return (
    <Group gap="sm" align="end">
      <Autocomplete
        size="xs"
        label="Aircraft"
        data={aircraft.data?.map((own) => own.name) ?? []}
        value={builtin ?? readKey(text, "aircraft", "name") ?? ""}
        disabled={builtin !== undefined}
        onChange={(value) => {
          onChange(setKey(text, "aircraft", 0, "name", value));
          if (aircraft.data?.some((own) => own.name === value)) void propose(value);
        }}
      />
      <TextInput
        label="Flight number"
        w={110}
        value={readKey(text, "flight", "number") ?? ""}
        onChange={(event) => {
          const digits = event.currentTarget.value.replaceAll(/\D/g, "");
          onChange(setKey(text, "flight", 0, "number", Number(digits)));
        }}
      />
      {text.includes("[maneuver]") && (
        <TextInput
          label="Maneuver"
          value={readKey(text, "maneuver", "label") ?? "{file}"}
          onChange={(event) => {
            onChange(setKey(text, "maneuver", 0, "label", event.currentTarget.value));
          }}
        />
      )}
      {(saved.length > 0 || text !== found.proposal.text) && (
        <Select
          label="Start from"
          placeholder="mapping"
          value={null}
          data={[
            { value: "", label: "proposal" },
            ...saved.map((own) => ({ value: String(own.id), label: own.name })),
          ]}
          onChange={(value) => {
            const selected = saved.find((own) => String(own.id) === value);
            onChange(selected?.text ?? found.proposal.text);
          }}
        />
      )}
    </Group>
  );
}

/** Problems of the mapping, and unit warnings to resolve. */
function Remarks({ checked, text, onChange }: Edit & { checked: CheckedMapping }) {
  const { problem, queries, repairs } = checked;
  const resolve = (warning: UnitWarning, key: string, value: string | string[]) => {
    const nth = checked.rules.findIndex(
      (rule) => (rule["name"] ?? rule["column"]) === warning.channel,
    );
    if (nth >= 0) onChange(setKey(text, "channels", nth, key, value));
  };
  return (
    <>
      {problem !== null && (
        <Alert color="red" variant="light" title="Mapping incomplete" data-testid="mapping-problem">
          {problem.message}
        </Alert>
      )}
      {repairs.length > 0 && (
        <Alert color="yellow" variant="light" title="Repaired" data-testid="mapping-repairs">
          <List size="sm">
            {repairs.map((text) => (
              <List.Item key={text}>{text}</List.Item>
            ))}
          </List>
        </Alert>
      )}
      {queries.map((warning) => (
        <Alert
          key={warning.channel}
          color="yellow"
          variant="light"
          title={`Check the unit of ${warning.channel}: ${warning.unit}`}
          data-testid="mapping-query"
        >
          <Text size="sm">
            The largest sample is {warning.largest.toPrecision(4)} {warning.unit}, unusually{" "}
            {warning.code === "too-large" ? "large" : "small"}.
          </Text>
          <Group gap="xs" mt="xs">
            {warning.instead.slice(0, 4).map((unit) => (
              <Button
                key={unit}
                size="xs"
                variant="default"
                onClick={() => {
                  resolve(warning, "unit", unit);
                }}
              >
                Use {unit}
              </Button>
            ))}
            <Button
              size="xs"
              variant="default"
              onClick={() => {
                resolve(warning, "confirmed", [warning.code]);
              }}
            >
              Confirm {warning.unit}
            </Button>
          </Group>
        </Alert>
      ))}
    </>
  );
}

/** Form that saves the mapping for further files of the same recorder. */
function SaveMapping({ text, usable }: { text: string; usable: boolean }) {
  const [name, setName] = useState("");
  const save = useSaveMapping();
  return (
    <Stack gap={4}>
      <Group gap="xs" align="end">
        <TextInput
          label="Save mapping as"
          placeholder="FTI recorder"
          value={name}
          onChange={(event) => {
            setName(event.currentTarget.value);
          }}
        />
        <Button
          variant="default"
          disabled={name.trim() === "" || !usable}
          loading={save.isPending}
          onClick={() => {
            save.mutate({ name: name.trim(), text });
          }}
        >
          {" "}
          Save{" "}
        </Button>
        {save.isSuccess && (
          <Text size="sm" className="quiet" role="status">
            Saved. The mapping is proposed for matching files.
          </Text>
        )}
      </Group>
      {save.isError && <ProblemAlert error={save.error} />}
    </Stack>
  );
}

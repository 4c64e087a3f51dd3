import {
  Alert,
  Autocomplete,
  Button,
  Group,
  SegmentedControl,
  Select,
  Stack,
  Text,
  Textarea,
  TextInput,
} from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi } from "@tanstack/react-router";
import { useState } from "react";
import { useKeepMapping } from "../api/commands";
import { aircraftQuery, mappingCheckQuery, mappingsQuery } from "../api/queries";
import type { CheckedMapping, Doubt, UploadDetail } from "../api/types";
import { readKey, setKey } from "../lib/mappingText";
import { useDraft } from "../lib/useDraft";
import { IMPORT_FORMS } from "../views";
import { FoundFields } from "./FoundFields";
import { ImportProgress } from "./ImportProgress";
import { MappingGuesses } from "./MappingGuesses";
import { MappingPreview } from "./MappingPreview";
import { MappingTable } from "./MappingTable";
import { ProblemAlert } from "./ProblemAlert";
import { Section } from "./Section";

const route = getRouteApi("/import");

/** The mapping of an upload: proposed, edited, checked, looked at, and carried out. */
export function ImportMapping({ found }: { found: UploadDetail }) {
  const { form = "table", channels = [] } = route.useSearch();
  const navigate = route.useNavigate();
  const id = found.upload.id;
  const { draft, setDraft, forget } = useDraft(`import-${id}`, { text: found.proposal.text });
  const { text } = draft;
  const setText = (changed: string) => {
    setDraft({ text: changed });
  };
  const [settled] = useDebouncedValue(text, 300);
  const check = useQuery(mappingCheckQuery(id, settled));
  const checked = check.data;
  const current = settled === text && !check.isPlaceholderData;
  const fine =
    current &&
    checked?.problem === null &&
    checked.questions.length === 0 &&
    checked.guesses.length === 0;

  return (
    <Stack gap="md">
      <FoundFields found={found} />
      <Section
        title="Mapping"
        note={`Proposed from ${found.proposal.origin}. It says what each column is; edits are kept in this tab.`}
        actions={
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
        }
      >
        <Stack gap="sm">
          <Belongings text={text} onChange={setText} found={found} />
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
                onChange={setText}
                shown={channels}
                onShow={(names) =>
                  void navigate({
                    search: (old) => ({ ...old, channels: names }),
                    replace: true,
                    resetScroll: false,
                  })
                }
              />
            )
          )}
          {check.isError && <ProblemAlert error={check.error} />}
          {checked !== undefined && <Remarks checked={checked} text={text} onChange={setText} />}
          {checked !== undefined && checked.guesses.length > 0 && (
            <MappingGuesses guesses={checked.guesses} text={text} onChange={setText} />
          )}
        </Stack>
      </Section>
      {checked?.problem === null && checked.channels.length > 0 && (
        <MappingPreview id={id} mapping={settled} channels={channels} />
      )}
      <Group justify="space-between" align="end">
        <Keep text={text} usable={current && checked?.problem === null} />
        <ImportProgress id={id} text={text} ready={fine} onImported={forget} />
      </Group>
    </Stack>
  );
}

interface Edit {
  text: string;
  onChange: (text: string) => void;
}

/** Which aircraft and flight, and what the maneuver is called. */
function Belongings({ text, onChange, found }: Edit & { found: UploadDetail }) {
  const aircraft = useQuery(aircraftQuery);
  const mappings = useQuery(mappingsQuery);
  const kept = mappings.data ?? [];
  const builtin = readKey(text, "aircraft", "builtin");
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
      {(kept.length > 0 || text !== found.proposal.text) && (
        <Select
          label="Begin with"
          placeholder="another mapping"
          value={null}
          data={[
            { value: "", label: "the proposal" },
            ...kept.map((own) => ({ value: String(own.id), label: own.name })),
          ]}
          onChange={(value) => {
            const chosen = kept.find((own) => String(own.id) === value);
            onChange(chosen?.text ?? found.proposal.text);
          }}
        />
      )}
    </Group>
  );
}

/** What is wrong with the mapping, and what it is asked. */
function Remarks({ checked, text, onChange }: Edit & { checked: CheckedMapping }) {
  const { problem, questions } = checked;
  const answer = (doubt: Doubt, key: string, value: string | string[]) => {
    const nth = checked.rules.findIndex(
      (rule) => (rule["name"] ?? rule["column"]) === doubt.channel,
    );
    if (nth >= 0) onChange(setKey(text, "channels", nth, key, value));
  };
  return (
    <>
      {problem !== null && (
        <Alert color="red" variant="light" title="Not yet" data-testid="mapping-problem">
          {problem.message}
        </Alert>
      )}
      {questions.map((doubt) => (
        <Alert
          key={doubt.channel}
          color="yellow"
          variant="light"
          title={`Is ${doubt.channel} really in ${doubt.unit}?`}
          data-testid="mapping-question"
        >
          <Text size="sm">
            The size of its samples is {doubt.largest.toPrecision(4)} {doubt.unit}, which is very{" "}
            {doubt.code === "too-large" ? "large" : "small"}.
          </Text>
          <Group gap="xs" mt="xs">
            {doubt.instead.slice(0, 4).map((unit) => (
              <Button
                key={unit}
                size="xs"
                variant="default"
                onClick={() => {
                  answer(doubt, "unit", unit);
                }}
              >
                It is in {unit}
              </Button>
            ))}
            <Button
              size="xs"
              variant="default"
              onClick={() => {
                answer(doubt, "confirmed", [doubt.code]);
              }}
            >
              {doubt.unit} is right
            </Button>
          </Group>
        </Alert>
      ))}
    </>
  );
}

/** Keep the mapping for the next files of the same recorder. */
function Keep({ text, usable }: { text: string; usable: boolean }) {
  const [name, setName] = useState("");
  const keep = useKeepMapping();
  return (
    <Stack gap={4}>
      <Group gap="xs" align="end">
        <TextInput
          label="Keep this mapping as"
          placeholder="FTI recorder"
          value={name}
          onChange={(event) => {
            setName(event.currentTarget.value);
          }}
        />
        <Button
          variant="default"
          disabled={name.trim() === "" || !usable}
          loading={keep.isPending}
          onClick={() => {
            keep.mutate({ name: name.trim(), text });
          }}
        >
          Keep
        </Button>
        {keep.isSuccess && (
          <Text size="sm" className="quiet" role="status">
            Kept; it is proposed for files that it fits.
          </Text>
        )}
      </Group>
      {keep.isError && <ProblemAlert error={keep.error} />}
    </Stack>
  );
}

import { Button, Group, Modal, Select, Stack, Text, Textarea } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { useState } from "react";
import { sameName, useAnalyst } from "../../api/analyst";
import { useAddNote, useDeleteNote, useEditNote } from "../../api/commands";
import { notesQuery, type NoteFilter } from "../../api/queries";
import type { Note, NoteRequest } from "../../api/types";
import { dateTime } from "../../lib/text/format";
import { useDraft } from "../../lib/drafts/useDraft";
import { NameForm } from "../account/AnalystMenu";
import { DerivativeName } from "./DerivativeName";
import { Loaded } from "./Loaded";
import { ProblemAlert } from "./ProblemAlert";

/** What a note can be about, and its label in the list of choices. */
export type NoteTopic = Pick<NoteRequest, "subject" | "key" | "aircraft_id"> & { label: string };

interface Props {
  filter: NoteFilter;
  /** The first one is proposed. */
  topics: NoteTopic[];
  /** Restricts the list to one kind of subject. */
  subject?: Note["subject"];
}

const isShown = (note: Note, subject: Note["subject"] | undefined) =>
  subject === undefined || note.subject === subject;

/** Button with the number of notes, which opens them. */
export function NotesButton(props: Props) {
  const [isOpen, setOpen] = useState(false);
  const { data } = useQuery(notesQuery(props.filter));
  const number = data?.filter((one) => isShown(one, props.subject)).length ?? 0;
  return (
    <>
      <Button
        variant="default"
        data-testid="open-notes"
        onClick={() => {
          setOpen(true);
        }}
      >
        Notes{number > 0 && ` (${String(number)})`}
      </Button>
      <Modal
        opened={isOpen}
        size="lg"
        title="Notes"
        onClose={() => {
          setOpen(false);
        }}
      >
        <Notes {...props} />
      </Modal>
    </>
  );
}

/** Notes in Markdown, oldest first, and a form for another. */
function Notes({ filter, topics, subject }: Props) {
  const notes = useQuery(notesQuery(filter));
  return (
    <Stack gap="sm">
      <Text size="xs" className="quiet">
        Markdown. Edits and deletions are recorded; nothing is overwritten.
      </Text>
      <Loaded query={notes} rows={2}>
        {(all) => {
          const shown = all.filter((one) => isShown(one, subject));
          return (
            <Stack gap="sm" data-testid="notes">
              {shown.length === 0 && (
                <Text size="sm" className="quiet">
                  No notes yet.
                </Text>
              )}
              {shown.map((note) => (
                <OneNote key={`${note.id} ${note.revision}`} note={note} />
              ))}
            </Stack>
          );
        }}
      </Loaded>
      {topics.length > 0 && <AddNote filter={filter} topics={topics} />}
    </Stack>
  );
}

function NoteAbout({ note }: { note: Note }) {
  const { key } = note;
  switch (note.subject) {
    case "run":
      return (
        <Link to="/runs/$id" params={{ id: Number(key) }} className="link">
          Run {key}
        </Link>
      );
    case "maneuver":
      return (
        <Link to="/maneuvers/$id" params={{ id: Number(key) }} className="link">
          Maneuver {key}
        </Link>
      );
    case "mode":
      return <>Mode {key}</>;
    case "derivative":
      return <DerivativeName name={key} />;
  }
}

function OneNote({ note }: { note: Note }) {
  const name = useAnalyst();
  const [text, setText] = useState<string | null>(null);
  const edit = useEditNote(note.id);
  const remove = useDeleteNote(note.id);
  const own = name !== "" && sameName(note.author, name);
  const failed = edit.error ?? remove.error;
  return (
    <article className="note" aria-label={`Note ${note.id}`} data-testid={`note-${note.id}`}>
      <Group gap="xs" justify="space-between">
        <Text size="xs" className="quiet numbers">
          <NoteAbout note={note} />, <b>{note.author}</b>
          {!note.author_verified && " (unverified)"}, {dateTime(note.created_at)}
          {note.revision > 1 && `, edited ${dateTime(note.changed_at)}`}
        </Text>
        {own && text === null && (
          <Group gap={4}>
            <Button
              variant="subtle"
              size="compact-xs"
              onClick={() => {
                setText(note.text);
              }}
            >
              Edit
            </Button>
            <Button
              variant="subtle"
              size="compact-xs"
              loading={remove.isPending}
              onClick={() => {
                remove.mutate(note.revision);
              }}
            >
              Delete
            </Button>
          </Group>
        )}
      </Group>
      {text === null ? (
        // The server renders it without HTML of the author, images and scripts.
        <div className="markdown" dangerouslySetInnerHTML={{ __html: note.html }} />
      ) : (
        <Stack gap="xs">
          <Textarea
            size="xs"
            aria-label="Text of the note"
            autosize
            minRows={3}
            maxLength={10_000}
            value={text}
            onChange={(event) => {
              setText(event.currentTarget.value);
            }}
          />
          <Group gap="xs">
            <Button
              size="compact-sm"
              disabled={text.trim() === "" || text === note.text}
              loading={edit.isPending}
              onClick={() => {
                edit.mutate({ revision: note.revision, text });
              }}
            >
              Save
            </Button>
            <Button
              variant="default"
              size="compact-sm"
              onClick={() => {
                setText(null);
              }}
            >
              Cancel
            </Button>
          </Group>
        </Stack>
      )}
      {failed !== null && <ProblemAlert error={failed} />}
      {note.revisions.length > 1 && (
        <details>
          <summary>
            {note.revisions.length - 1 === 1
              ? "One earlier revision"
              : `${note.revisions.length - 1} earlier revisions`}
          </summary>
          {note.revisions.slice(0, -1).map((one) => (
            <Text key={one.revision} size="xs" style={{ whiteSpace: "pre-wrap" }}>
              {dateTime(one.created_at)}: {one.text}
            </Text>
          ))}
        </details>
      )}
    </article>
  );
}

function AddNote({ filter, topics }: { filter: NoteFilter; topics: NoteTopic[] }) {
  const name = useAnalyst();
  const { draft, setDraft } = useDraft(`flexsid.note.${JSON.stringify(filter)}`, {
    topic: 0,
    text: "",
  });
  const add = useAddNote();
  const place = draft.topic < topics.length ? draft.topic : 0;
  const topic = topics[place];
  if (name === "") {
    return (
      <Stack gap="xs" mt="sm">
        <Text size="sm">Set your name to add a note.</Text>
        <NameForm />
      </Stack>
    );
  }
  return (
    <Stack gap="xs" mt="sm" maw={720}>
      {topics.length > 1 && (
        <Select
          size="xs"
          label="Note on"
          searchable
          allowDeselect={false}
          maw={320}
          data={topics.map(({ label }, index) => ({ value: String(index), label }))}
          value={String(place)}
          onChange={(value) => {
            setDraft({ ...draft, topic: Number(value) });
          }}
        />
      )}
      <Textarea
        size="xs"
        label="New note"
        autosize
        minRows={2}
        maxLength={10_000}
        data-testid="note-text"
        value={draft.text}
        onChange={(event) => {
          setDraft({ ...draft, text: event.currentTarget.value });
        }}
      />
      <Group gap="xs">
        <Button
          variant="default"
          disabled={draft.text.trim() === "" || topic === undefined}
          loading={add.isPending}
          data-testid="add-note"
          onClick={() => {
            if (topic === undefined) return;
            const { subject, key, aircraft_id } = topic;
            add.mutate(
              { subject, key, aircraft_id, text: draft.text },
              {
                onSuccess: () => {
                  setDraft({ ...draft, text: "" });
                },
              },
            );
          }}
        >
          Add note
        </Button>
        <Text size="xs" className="quiet">
          As {name}
        </Text>
      </Group>
      {add.isError && <ProblemAlert error={add.error} />}
    </Stack>
  );
}

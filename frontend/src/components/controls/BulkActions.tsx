import { Button, Group, Popover, Text, TextInput } from "@mantine/core";
import { useState, type ReactNode, type SubmitEvent } from "react";
import { asProblem } from "../../api/problem";
import { useChangeMany } from "../../api/commands";
import type { Action, ManyOf } from "../../api/types";
import { notify } from "../../lib/notice";

interface Props {
  records: ManyOf;
  ids: number[];
  /** Tags that exist, offered while typing. */
  tags: readonly string[];
  /** The list shows deleted records. */
  deleted: boolean;
  onClear: () => void;
  /** What else can be done with these. */
  children?: ReactNode;
}

const OPPOSITE: Record<Action, Action> = {
  delete: "restore",
  restore: "delete",
  tag: "untag",
  untag: "tag",
};

const DONE: Record<Action, string> = {
  delete: "deleted",
  restore: "restored",
  tag: "tagged",
  untag: "untagged",
};

/** Actions on all selected rows; each can be undone. */
export function BulkActions({ records, ids, tags, deleted, onClear, children }: Props) {
  const change = useChangeMany(records);
  const act = async (action: Action, tag?: string) => {
    notify(null); // undo is offered for the last action only
    try {
      const { ids: changed } = await change.mutateAsync({ ids, action, tag });
      if (action === "delete" || action === "restore") onClear();
      const noun = changed.length === 1 ? records.slice(0, -1) : records;
      notify({
        text: `${changed.length} ${noun} ${DONE[action]}${tag === undefined ? "" : ` “${tag}”`}.`,
        undo:
          changed.length === 0
            ? undefined
            : () => {
                change.mutate({ ids: changed, action: OPPOSITE[action], tag });
              },
      });
    } catch (error) {
      notify({ text: asProblem(error).detail });
    }
  };
  return (
    <Group gap="xs" data-testid="bulk-actions">
      <Text size="sm" className="quiet numbers">
        {ids.length} selected
      </Text>
      <Button variant="subtle" onClick={onClear}>
        Clear selection
      </Button>
      {deleted ? (
        <Button variant="default" data-testid="bulk-restore" onClick={() => void act("restore")}>
          Restore
        </Button>
      ) : (
        <>
          <TagButton tags={tags} onTag={(action, tag) => void act(action, tag)} />
          <Button variant="default" data-testid="bulk-delete" onClick={() => void act("delete")}>
            Delete
          </Button>
          {children}
        </>
      )}
    </Group>
  );
}

interface TagProps {
  tags: readonly string[];
  onTag: (action: "tag" | "untag", tag: string) => void;
}

function TagButton({ tags, onTag }: TagProps) {
  const [open, setOpen] = useState(false);
  const [tag, setTag] = useState("");
  const put = (action: "tag" | "untag") => {
    const word = tag.trim();
    if (word === "") return;
    setOpen(false);
    setTag("");
    onTag(action, word);
  };
  const submit = (event: SubmitEvent) => {
    event.preventDefault();
    put("tag");
  };
  return (
    <Popover opened={open} onChange={setOpen} trapFocus returnFocus position="bottom-end">
      <Popover.Target>
        <Button
          variant="default"
          data-testid="bulk-tag"
          onClick={() => {
            setOpen(!open);
          }}
        >
          Tag…
        </Button>
      </Popover.Target>
      <Popover.Dropdown>
        <form onSubmit={submit}>
          <TextInput
            label="Tag"
            description="A short word, without commas"
            list="known-tags"
            maxLength={64}
            pattern="[^,]*"
            value={tag}
            data-autofocus
            data-testid="tag-text"
            onChange={(event) => {
              setTag(event.currentTarget.value);
            }}
          />
          <datalist id="known-tags">
            {tags.map((known) => (
              <option key={known} value={known} />
            ))}
          </datalist>
          <Group mt="xs" gap="xs">
            <Button type="submit">Add tag</Button>
            <Button
              variant="default"
              onClick={() => {
                put("untag");
              }}
            >
              Remove tag
            </Button>
          </Group>
        </form>
      </Popover.Dropdown>
    </Popover>
  );
}

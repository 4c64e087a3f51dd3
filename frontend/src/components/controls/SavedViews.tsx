import { Button, CloseButton, Group, Popover, Stack, Text, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useNavigate, useRouterState } from "@tanstack/react-router";
import { useState, type SubmitEvent } from "react";
import { useDeleteView, useSaveView } from "../../api/commands";
import { savedViewsQuery } from "../../api/queries";
import type { SavedViewRequest } from "../../api/types";
import { ProblemAlert } from "../display/ProblemAlert";

/** Named views of this page, shared by all analysts. */
export function SavedViews({ page }: { page: SavedViewRequest["page"] }) {
  const [open, setOpen] = useState(false);
  const [name, setName] = useState("");
  const views = useQuery(savedViewsQuery(page));
  const save = useSaveView();
  const remove = useDeleteView();
  const navigate = useNavigate();
  const here = useRouterState({ select: (state) => state.location });
  const submit = (event: SubmitEvent) => {
    event.preventDefault();
    save.mutate(
      { page, name: name.trim(), search: here.searchStr, author: "" },
      {
        onSuccess: () => {
          setName("");
        },
      },
    );
  };
  return (
    <Popover
      opened={open}
      onChange={setOpen}
      trapFocus
      returnFocus
      position="bottom-end"
      width={300}
    >
      <Popover.Target>
        <Button
          variant="default"
          data-testid="saved-views"
          onClick={() => {
            setOpen(!open);
          }}
        >
          Views
        </Button>
      </Popover.Target>
      <Popover.Dropdown>
        <Stack gap="xs">
          {views.data?.length === 0 && (
            <Text size="sm" className="quiet">
              No saved view of this page yet.
            </Text>
          )}
          {views.data?.map((view) => (
            <Group key={view.id} justify="space-between" wrap="nowrap" gap={4}>
              <a
                href={`${here.pathname}${view.search}`}
                className="link"
                data-testid={`saved-view-${view.id}`}
                onClick={(event) => {
                  if (event.metaKey || event.ctrlKey) return;
                  event.preventDefault();
                  setOpen(false);
                  void navigate({ href: `${here.pathname}${view.search}` });
                }}
              >
                {view.name}
              </a>
              <CloseButton
                aria-label={`Delete view ${view.name}`}
                onClick={() => {
                  remove.mutate(view.id);
                }}
              />
            </Group>
          ))}
          <form onSubmit={submit}>
            <Group gap="xs" align="flex-end" wrap="nowrap">
              <TextInput
                label="Save current view as"
                required
                withAsterisk={false}
                maxLength={200}
                value={name}
                style={{ flex: 1 }}
                data-testid="view-name"
                onChange={(event) => {
                  setName(event.currentTarget.value);
                }}
              />
              <Button type="submit" loading={save.isPending}>
                Save
              </Button>
            </Group>
          </form>
          {save.isError && <ProblemAlert error={save.error} />}
        </Stack>
      </Popover.Dropdown>
    </Popover>
  );
}

import { Autocomplete, Button, Popover, Stack, Text, Textarea } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { useSaveTemplate } from "../../api/commands";
import { maneuverQuery, runTemplatesQuery } from "../../api/queries";
import type { Run } from "../../api/types";
import { ProblemAlert } from "../display/ProblemAlert";

/** Saves method and settings of a run under a name, as a new template or a new revision. */
export function TemplateMenu({ run }: { run: Run }) {
  const [open, setOpen] = useState(false);
  return (
    <Popover opened={open} onChange={setOpen} trapFocus returnFocus position="bottom-end">
      <Popover.Target>
        <Button
          variant="default"
          data-testid="save-template"
          onClick={() => {
            setOpen(!open);
          }}
        >
          Save as template
        </Button>
      </Popover.Target>
      <Popover.Dropdown>
        {open && (
          <TemplateForm
            run={run}
            onDone={() => {
              setOpen(false);
            }}
          />
        )}
      </Popover.Dropdown>
    </Popover>
  );
}

function TemplateForm({ run, onDone }: { run: Run; onDone: () => void }) {
  const maneuver = useQuery(maneuverQuery(run.maneuver_id));
  const aircraft = maneuver.data?.aircraft_id;
  const known = useQuery({ ...runTemplatesQuery(aircraft), enabled: aircraft !== undefined });
  const [name, setName] = useState("");
  const [note, setNote] = useState("");
  const save = useSaveTemplate();
  const plain = name.trim();
  const present = known.data?.find((one) => one.name.toLowerCase() === plain.toLowerCase());
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        save.mutate({ runId: run.id, name: plain, note, present }, { onSuccess: onDone });
      }}
    >
      <Stack gap="xs" w={320}>
        <Autocomplete
          label="Name"
          required
          withAsterisk={false}
          maxLength={200}
          data={(known.data ?? []).map((one) => one.name)}
          data-testid="template-name"
          value={name}
          comboboxProps={{ withinPortal: false }}
          onChange={setName}
        />
        <Textarea
          label="Note"
          autosize
          minRows={2}
          maxLength={2000}
          value={note}
          onChange={(event) => {
            setNote(event.currentTarget.value);
          }}
        />
        <Text size="xs" className="quiet">
          Method and settings of run {run.id}. Model structure, modal tables and prediction remain
          those of each maneuver; additional maneuvers, the run to start from and priors by value
          are not part of a template.
        </Text>
        {save.isError && <ProblemAlert error={save.error} />}
        <Button type="submit" loading={save.isPending} disabled={plain === ""}>
          {present === undefined ? "Save template" : `Save as revision ${present.revision + 1}`}
        </Button>
      </Stack>
    </form>
  );
}

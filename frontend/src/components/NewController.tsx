import { Button, Collapse, FileInput, Select, Stack, Textarea, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { useKeepController } from "../api/commands";
import { aircraftQuery } from "../api/queries";
import { ProblemAlert } from "./ProblemAlert";

const EXAMPLE = `{"reads": ["q"], "drives": ["wf4s"], "delay_s": 0.01,
 "transfer": {"wf4s": {"q": {"num": [0.2], "den": [0.02, 1]}}}}`;

/** A controller pasted as JSON, or from a JSON or MATLAB file. */
export function NewController({ onKept }: { onKept: (id: number) => void }) {
  const aircraft = useQuery(aircraftQuery);
  const keep = useKeepController();
  const [open, setOpen] = useState(false);
  const [owner, setOwner] = useState<string | null>(null);
  const [name, setName] = useState("");
  const [text, setText] = useState("");
  const [file, setFile] = useState<File | null>(null);
  const [reads, setReads] = useState("");
  const [drives, setDrives] = useState("");
  const chosen = owner ?? String(aircraft.data?.[0]?.id ?? "");
  const matlab = file?.name.toLowerCase().endsWith(".mat") === true;
  return (
    <Stack gap="xs">
      <Button
        variant="default"
        aria-expanded={open}
        onClick={() => {
          setOpen(!open);
        }}
      >
        Another controller
      </Button>
      <Collapse expanded={open}>
        <form
          onSubmit={(event) => {
            event.preventDefault();
            keep.mutate(
              { aircraft: Number(chosen), name, text, file, reads, drives },
              {
                onSuccess: (kept) => {
                  setOpen(false);
                  onKept(kept.id);
                },
              },
            );
          }}
        >
          <Stack gap="xs">
            <Select
              label="Aircraft"
              allowDeselect={false}
              data={(aircraft.data ?? []).map((one) => ({
                value: String(one.id),
                label: one.name,
              }))}
              value={chosen === "" ? null : chosen}
              onChange={setOwner}
            />
            <TextInput
              label="Name"
              required
              maxLength={200}
              value={name}
              onChange={(event) => {
                setName(event.currentTarget.value);
              }}
            />
            <FileInput
              label="JSON or MATLAB file"
              description="MATLAB: variables A, B, C, D"
              clearable
              accept=".json,.mat"
              value={file}
              onChange={setFile}
            />
            {matlab && (
              <>
                <TextInput
                  label="Signals read, by commas"
                  required
                  value={reads}
                  onChange={(event) => {
                    setReads(event.currentTarget.value);
                  }}
                />
                <TextInput
                  label="Surfaces driven, by commas"
                  required
                  value={drives}
                  onChange={(event) => {
                    setDrives(event.currentTarget.value);
                  }}
                />
              </>
            )}
            {file === null && (
              <Textarea
                label="Or its JSON"
                description="u = K y in SI and rad: A, B, C, D, laws by airspeed, or transfer functions"
                autosize
                minRows={6}
                placeholder={EXAMPLE}
                value={text}
                onChange={(event) => {
                  setText(event.currentTarget.value);
                }}
              />
            )}
            {keep.isError && <ProblemAlert error={keep.error} />}
            <Button
              type="submit"
              loading={keep.isPending}
              disabled={chosen === "" || (file === null && text.trim() === "")}
            >
              Keep it
            </Button>
          </Stack>
        </form>
      </Collapse>
    </Stack>
  );
}

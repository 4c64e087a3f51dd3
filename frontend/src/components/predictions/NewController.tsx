import { Button, Collapse, FileInput, Select, Stack, Textarea, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { useSaveController } from "../../api/commands";
import { aircraftQuery } from "../../api/queries";
import { ProblemAlert } from "../display/ProblemAlert";

const EXAMPLE = `{"reads": ["q"], "drives": ["wf4s"], "delay_s": 0.01,
 "transfer": {"wf4s": {"q": {"num": [0.2], "den": [0.02, 1]}}}}`;

/** A controller pasted as JSON, or from a JSON or MATLAB file. */
export function NewController({ onSaved }: { onSaved: (id: number) => void }) {
  const aircraft = useQuery(aircraftQuery);
  const save = useSaveController();
  const [open, setOpen] = useState(false);
  const [aircraftId, setAircraftId] = useState<string | null>(null);
  const [name, setName] = useState("");
  const [text, setText] = useState("");
  const [file, setFile] = useState<File | null>(null);
  const [reads, setReads] = useState("");
  const [drives, setDrives] = useState("");
  const selected = aircraftId ?? String(aircraft.data?.[0]?.id ?? "");
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
        New controller
      </Button>
      <Collapse expanded={open}>
        <form
          onSubmit={(event) => {
            event.preventDefault();
            save.mutate(
              { aircraft: Number(selected), name, text, file, reads, drives },
              {
                onSuccess: (saved) => {
                  setOpen(false);
                  onSaved(saved.id);
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
              value={selected === "" ? null : selected}
              onChange={setAircraftId}
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
                  label="Input signals, comma-separated"
                  required
                  value={reads}
                  onChange={(event) => {
                    setReads(event.currentTarget.value);
                  }}
                />
                <TextInput
                  label="Surfaces, comma-separated"
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
                label="JSON"
                description="u = K y in SI and rad: A, B, C, D, laws by airspeed, or transfer functions; with mixer: commands, and weights by surface and command; rate_limit_rad_s of every surface"
                autosize
                minRows={6}
                placeholder={EXAMPLE}
                value={text}
                onChange={(event) => {
                  setText(event.currentTarget.value);
                }}
              />
            )}
            {save.isError && <ProblemAlert error={save.error} />}
            <Button
              type="submit"
              loading={save.isPending}
              disabled={selected === "" || (file === null && text.trim() === "")}
            >
              Save
            </Button>
          </Stack>
        </form>
      </Collapse>
    </Stack>
  );
}

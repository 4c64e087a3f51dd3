import { Button, FileInput, Group, Modal, Stack, Text } from "@mantine/core";
import { useNavigate } from "@tanstack/react-router";
import { useState } from "react";
import { useImportManeuver } from "../api/commands";
import { ProblemAlert } from "./ProblemAlert";

interface Props {
  opened: boolean;
  onClose: () => void;
}

/** Recorded files and the mapping that names their channels, units and roles. */
export function ImportDialog({ opened, onClose }: Props) {
  const [files, setFiles] = useState<File[]>([]);
  const [mapping, setMapping] = useState<File | null>(null);
  const upload = useImportManeuver();
  const navigate = useNavigate();
  const close = () => {
    upload.reset();
    onClose();
  };
  const submit = () => {
    if (mapping === null) return;
    upload.mutate(
      { files, mapping },
      {
        onSuccess: (maneuver) => {
          close();
          void navigate({ to: "/maneuvers/$id", params: { id: maneuver.id } });
        },
      },
    );
  };

  return (
    <Modal opened={opened} onClose={close} title="Import a maneuver" size="lg" centered>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          submit();
        }}
      >
        <Stack gap="md">
          <FileInput
            label="Recorded data"
            description="One file, or several recorded at different rates: CSV or MATLAB"
            placeholder="Choose files"
            multiple
            clearable
            value={files}
            onChange={setFiles}
            data-testid="import-files"
          />
          <FileInput
            label="Mapping"
            description="TOML that gives each column its channel name, unit and role"
            placeholder="Choose a file"
            accept=".toml"
            clearable
            value={mapping}
            onChange={setMapping}
            data-testid="import-mapping"
          />
          {upload.isError && (
            <>
              <ProblemAlert error={upload.error} />
              <Text size="sm" className="quiet">
                Nothing was stored.
              </Text>
            </>
          )}
          <Group justify="flex-end">
            <Button variant="default" onClick={close}>
              Close
            </Button>
            <Button
              type="submit"
              disabled={files.length === 0 || mapping === null}
              loading={upload.isPending}
              data-testid="import-submit"
            >
              Import
            </Button>
          </Group>
        </Stack>
      </form>
    </Modal>
  );
}

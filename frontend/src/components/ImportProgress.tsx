import { Alert, Button, Group, Progress, Stack, Text } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useNavigate } from "@tanstack/react-router";
import { useEffect, useRef } from "react";
import { useDiscardUpload, useImportUpload } from "../api/commands";
import { uploadStateQuery } from "../api/queries";
import { ButtonLink } from "./ButtonLink";
import { ProblemAlert } from "./ProblemAlert";

interface Props {
  id: string;
  text: string;
  /** The mapping is valid and has no open warnings. */
  ready: boolean;
  onImported: () => void;
}

/** Starts an import, shows its progress, and links to the result. */
export function ImportProgress({ id, text, ready, onImported }: Props) {
  const state = useQuery(uploadStateQuery(id));
  const begin = useImportUpload(id);
  const cancel = useDiscardUpload(id);
  const cache = useQueryClient();
  const navigate = useNavigate();
  const begun = useRef(false);
  const upload = state.data;
  const goesOn = upload?.state === "importing";

  useEffect(() => {
    if (!begun.current || upload?.state !== "imported") return;
    begun.current = false;
    onImported();
    void cache.invalidateQueries({ queryKey: ["maneuvers"] });
    void cache.invalidateQueries({ queryKey: ["flights"] });
    if (upload.maneuver_id !== null) {
      void navigate({ to: "/maneuvers/$id", params: { id: upload.maneuver_id } });
    }
  }, [upload, onImported, cache, navigate]);

  return (
    <Stack gap="xs" style={{ flex: "1 1 320px", maxWidth: 560 }}>
      {upload?.state === "failed" && (
        <Alert color="red" variant="light" title="Nothing was stored" data-testid="import-failed">
          {upload.message}
        </Alert>
      )}
      {upload?.state === "imported" && (
        <Alert color="teal" variant="light" title="Imported" data-testid="imported">
          {upload.maneuver_id !== null ? (
            <ButtonLink
              size="xs"
              variant="default"
              to="/maneuvers/$id"
              params={{ id: upload.maneuver_id }}
            >
              Open the maneuver
            </ButtonLink>
          ) : (
            <Group gap="sm">
              {`The whole flight was stored with ${String(upload.n_channels ?? 0)} channels.`}
              {upload.flight_id !== null && (
                <ButtonLink
                  size="xs"
                  variant="default"
                  to="/flights/$id"
                  params={{ id: upload.flight_id }}
                >
                  Cut maneuvers
                </ButtonLink>
              )}
            </Group>
          )}
        </Alert>
      )}
      {begin.isError && <ProblemAlert error={begin.error} />}
      {goesOn && (
        <Progress
          value={100 * (upload.progress ?? 0)}
          aria-label="Import"
          data-testid="import-progress"
        />
      )}
      <Group justify="end" gap="sm">
        {!ready && !goesOn && (
          <Text size="sm" className="quiet">
            Resolve the warnings above first.
          </Text>
        )}
        {goesOn ? (
          <Button
            variant="default"
            onClick={() => {
              cancel.mutate();
            }}
          >
            Cancel
          </Button>
        ) : (
          <Button
            disabled={!ready}
            loading={begin.isPending}
            data-testid="import-submit"
            onClick={() => {
              begin.mutate(text, {
                onSuccess: () => {
                  begun.current = true;
                },
              });
            }}
          >
            Import
          </Button>
        )}
      </Group>
    </Stack>
  );
}

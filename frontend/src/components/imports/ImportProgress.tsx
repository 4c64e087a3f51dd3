import { Alert, Button, Group, Stack, Text } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useNavigate } from "@tanstack/react-router";
import { useEffect, useEffectEvent, useRef } from "react";
import { useImportUpload } from "../../api/commands";
import { importJobQuery } from "../../api/queries";
import { isOver, type Job } from "../../api/types";
import { ButtonLink } from "../controls/ButtonLink";
import { JobWait } from "../jobs/JobWait";
import { ProblemAlert } from "../display/ProblemAlert";

interface Props {
  id: string;
  text: string;
  /** The mapping is valid and has no open warnings. */
  ready: boolean;
}

/** Starts an import, shows its job, and links to the result. */
export function ImportProgress({ id, text, ready }: Props) {
  const found = useQuery(importJobQuery(id));
  const begin = useImportUpload(id);
  const cache = useQueryClient();
  const navigate = useNavigate();
  const begun = useRef(false);
  const job = found.data?.job ?? null;
  const goesOn = job !== null && !isOver(job.state);

  // The end is seen by the wait for the job, or by reading the import again: whichever is first.
  const open = useEffectEvent((ended: Job) => {
    if (!begun.current) return;
    begun.current = false;
    for (const key of ["uploads", "maneuvers", "flights"]) {
      void cache.invalidateQueries({ queryKey: [key] });
    }
    const { maneuverId } = imported(ended);
    if (maneuverId !== null) void navigate({ to: "/maneuvers/$id", params: { id: maneuverId } });
  });
  useEffect(() => {
    if (job?.state === "succeeded") open(job);
  }, [job]);

  const finish = (ended: Job) => {
    const { queryKey } = importJobQuery(id);
    // A response that is under way may show the job before its end, and would remain.
    void cache.cancelQueries({ queryKey }).then(() => {
      cache.setQueryData(queryKey, { job: ended });
    });
  };

  return (
    <Stack gap="xs" style={{ flex: "1 1 320px", maxWidth: 560 }}>
      {job?.state === "succeeded" && <Imported job={job} />}
      {begin.isError && <ProblemAlert error={begin.error} />}
      {job !== null && job.state !== "succeeded" && (
        <JobWait key={job.id} id={job.id} onEnd={finish} />
      )}
      {!goesOn && (
        <Group justify="end" gap="sm">
          {!ready && (
            <Text size="sm" className="quiet">
              Resolve the warnings above first.
            </Text>
          )}
          <Button
            disabled={!ready}
            loading={begin.isPending}
            data-testid="import-submit"
            onClick={() => {
              begun.current = true;
              begin.mutate(text);
            }}
          >
            Import
          </Button>
        </Group>
      )}
    </Stack>
  );
}

function Imported({ job }: { job: Job }) {
  const { maneuverId, flightId, channels } = imported(job);
  return (
    <Alert color="teal" variant="light" title="Imported" data-testid="imported">
      {maneuverId !== null ? (
        <ButtonLink size="xs" variant="default" to="/maneuvers/$id" params={{ id: maneuverId }}>
          Open the maneuver
        </ButtonLink>
      ) : (
        <Group gap="sm">
          {`The whole flight was stored with ${String(channels)} channels.`}
          {flightId !== null && (
            <ButtonLink size="xs" variant="default" to="/flights/$id" params={{ id: flightId }}>
              Cut maneuvers
            </ButtonLink>
          )}
        </Group>
      )}
    </Alert>
  );
}

/** What an import has stored. */
function imported({ result }: Job) {
  const id = (key: string) => (typeof result?.[key] === "number" ? result[key] : null);
  return {
    maneuverId: id("maneuver_id"),
    flightId: id("flight_id"),
    channels: id("n_channels") ?? 0,
  };
}

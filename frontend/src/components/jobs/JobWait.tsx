import { Alert, Button, Group, Progress, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { useEffect, useEffectEvent } from "react";
import { useCancelJob, useRetryJob } from "../../api/commands";
import { jobQuery, queueQuery } from "../../api/queries";
import { isOver, type Job } from "../../api/types";
import { count, duration } from "../../lib/text/format";
import { ProblemAlert } from "../display/ProblemAlert";

interface Props {
  id: number;
  /** Called when the job has ended, in whichever state; again if it is retried. */
  onEnd?: (job: Job) => void;
}

/** Progress of a job that the page waits for, with a button to cancel it. */
export function JobWait({ id, onEnd }: Props) {
  const found = useQuery(jobQuery(id));
  const cancel = useCancelJob();
  const retry = useRetryJob();
  const job = found.data;
  const ended = job !== undefined && isOver(job.state);
  const endedAt = job?.finished_at ?? null;
  const reportEnd = useEffectEvent(() => {
    if (job !== undefined) onEnd?.(job);
  });
  useEffect(() => {
    if (endedAt !== null) reportEnd();
  }, [endedAt]);
  return (
    <div data-testid="job-wait">
      {found.isError && <ProblemAlert error={found.error} onRetry={() => void found.refetch()} />}
      {cancel.isError && <ProblemAlert error={cancel.error} />}
      {retry.isError && <ProblemAlert error={retry.error} />}
      {job?.state === "failed" && (
        <Alert color="red" variant="light" title="Nothing was stored">
          {job.error?.message}
        </Alert>
      )}
      {job?.state === "cancelled" && (
        <Alert color="yellow" variant="light">
          Cancelled; nothing was stored.
        </Alert>
      )}
      {(job?.state === "failed" || job?.state === "cancelled") && (
        <Button
          mt="xs"
          variant="default"
          size="compact-sm"
          loading={retry.isPending}
          onClick={() => {
            retry.mutate(id);
          }}
        >
          Retry
        </Button>
      )}
      {job !== undefined && !ended && (
        <>
          <Group justify="space-between" mb={6}>
            <Text size="sm" className="numbers" aria-live="polite">
              {stateText(job)}
              <UsualTime kind={job.kind} />{" "}
              <Link to="/jobs/$id" params={{ id }} className="link">
                Job {id}
              </Link>
            </Text>
            <Button
              variant="default"
              size="compact-sm"
              loading={cancel.isPending}
              onClick={() => {
                cancel.mutate(id);
              }}
            >
              Cancel
            </Button>
          </Group>
          <Progress
            value={job.state === "running" ? Math.max(3, 100 * (job.progress?.fraction ?? 0)) : 0}
            animated={job.state === "running"}
            aria-label="Progress"
          />
        </>
      )}
    </div>
  );
}

const SHORT_S = 5;

/** How long jobs of a kind usually take, where it is long enough to wait for. */
export function UsualTime({ kind }: { kind: string }) {
  const usual = useQuery({ ...queueQuery, staleTime: 60_000 }).data?.typical_s[kind];
  if (usual === undefined || usual < SHORT_S) return null;
  return `, usually ${usual < 60 ? `${Math.round(usual)} s` : duration(usual)}`;
}

/** What a job that has not ended does or waits for. */
export function stateText(job: Job): string {
  if (job.state === "running") return job.progress?.message ?? "Starting";
  if (job.after_job_id !== null) return `Waiting for run ${job.after_job_id}`;
  return job.position ? `Waiting behind ${count(job.position, "job")}` : "Waiting for a worker";
}

import { Button, Group, Progress, Text } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import { useCancelJob, useRetryJob } from "../api/commands";
import { isOver, type Job } from "../api/types";
import { dateTime, elapsed } from "../lib/format";
import { DataTable, type Column } from "./DataTable";
import { ProblemAlert } from "./ProblemAlert";
import { StateBadge } from "./RunBadge";

/** Jobs with their progress and actions. */
export function JobTable({ jobs }: { jobs: Job[] }) {
  const cancel = useCancelJob();
  const retry = useRetryJob();
  const columns: Column<Job>[] = [
    {
      key: "run",
      header: "Run",
      render: (job) => (
        <Link to="/runs/$id" params={{ id: job.run_id }} className="link">
          {job.method} run {job.run_id}
        </Link>
      ),
    },
    {
      key: "maneuver",
      header: "Maneuver",
      render: (job) => (
        <Link to="/maneuvers/$id" params={{ id: job.maneuver_id }} className="link">
          {job.maneuver_label}
        </Link>
      ),
    },
    { key: "state", header: "State", render: (job) => <StateBadge state={job.state} /> },
    { key: "progress", header: "Progress", render: (job) => <JobState job={job} /> },
    {
      key: "took",
      header: "Duration",
      numeric: true,
      render: (job) => elapsed(job.started_at, job.finished_at),
    },
    { key: "at", header: "Requested", numeric: true, render: (job) => dateTime(job.created_at) },
    {
      key: "log",
      header: "",
      render: (job) => (
        <Group gap={6} wrap="nowrap" justify="flex-end">
          <Link to="/jobs/$id" params={{ id: job.id }} className="link">
            Log
          </Link>
          {!isOver(job.state) && (
            <Button
              variant="default"
              size="compact-xs"
              aria-label={`Cancel run ${job.id}`}
              onClick={() => {
                cancel.mutate(job.id);
              }}
            >
              Cancel
            </Button>
          )}
          {(job.state === "failed" || job.state === "cancelled") && (
            <Button
              variant="default"
              size="compact-xs"
              aria-label={`Retry run ${job.id}`}
              onClick={() => {
                retry.mutate(job.id);
              }}
            >
              Retry
            </Button>
          )}
        </Group>
      ),
    },
  ];
  return (
    <>
      {cancel.isError && <ProblemAlert error={cancel.error} />}
      {retry.isError && <ProblemAlert error={retry.error} />}
      <DataTable
        label="Jobs"
        testId="jobs-table"
        columns={columns}
        rows={jobs}
        rowKey={(job) => job.id}
      />
    </>
  );
}

function JobState({ job }: { job: Job }) {
  if (job.state === "failed") {
    return (
      <Text size="sm" truncate maw={360} title={job.error?.message}>
        {job.error?.message ?? ""}
      </Text>
    );
  }
  if (job.state === "queued" && job.after_run_id !== null) {
    return (
      <Text size="xs" className="quiet">
        starts from run {job.after_run_id}
      </Text>
    );
  }
  if (job.state !== "running") return null;
  return (
    <Group gap="xs" wrap="nowrap">
      <Progress value={100 * (job.progress?.fraction ?? 0)} w={120} aria-label="Progress" />
      <Text size="xs" className="quiet">
        iteration {job.progress?.iteration ?? 0}
      </Text>
    </Group>
  );
}

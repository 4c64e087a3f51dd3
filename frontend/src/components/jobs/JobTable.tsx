import { Button, Group, Progress, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { useCancelJob, useRetryJob } from "../../api/commands";
import { jobKindsQuery } from "../../api/queries";
import { isOver, type Job } from "../../api/types";
import { jobAddress } from "../../lib/jobAddress";
import { dateTime, elapsed } from "../../lib/text/format";
import { parseSearch } from "../../lib/urlState";
import { DataTable, type Column } from "../controls/DataTable";
import { stateText } from "./JobWait";
import { ProblemAlert } from "../display/ProblemAlert";
import { StateBadge } from "../runs/RunBadge";

/** Jobs with their progress and actions. */
export function JobTable({ jobs }: { jobs: Job[] }) {
  const cancel = useCancelJob();
  const retry = useRetryJob();
  const columns: Column<Job>[] = [
    { key: "kind", header: "Job", render: (job) => <JobSubject job={job} /> },
    {
      key: "title",
      header: "Of",
      wraps: true,
      render: (job) =>
        job.maneuver_id === null ? (
          job.title
        ) : (
          <Link to="/maneuvers/$id" params={{ id: job.maneuver_id }} className="link">
            {job.title}
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
    { key: "author", header: "By", render: (job) => job.author },
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
              aria-label={`Cancel job ${job.id}`}
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
              aria-label={`Retry job ${job.id}`}
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

/** Kind of a job, with a link to what it works on. */
function JobSubject({ job }: { job: Job }) {
  const kinds = useQuery(jobKindsQuery);
  if (job.run_id !== null) {
    return (
      <Link to="/runs/$id" params={{ id: job.run_id }} className="link">
        {job.method} run {job.run_id}
      </Link>
    );
  }
  const kind = kinds.data?.find((one) => one.name === job.kind);
  const label = kind?.label ?? job.kind;
  const to = jobAddress(kind?.page ?? "", job);
  if (to === null) return label;
  if (to.startsWith("/api/")) {
    if (job.state !== "succeeded") return label;
    return (
      <a href={to} target="_blank" rel="noopener" className="link">
        {label}
      </a>
    );
  }
  const { pathname, search, hash } = new URL(to, window.location.origin);
  return (
    // The server knows the addresses of the page; the compiler does not know which it names.
    <Link
      to={pathname as "/jobs"}
      search={parseSearch(search) as never}
      hash={hash.slice(1)}
      className="link"
    >
      {label}
    </Link>
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
  if (isOver(job.state)) return null;
  return (
    <Group gap="xs" wrap="nowrap">
      {job.state === "running" && (
        <Progress value={100 * (job.progress?.fraction ?? 0)} w={120} aria-label="Progress" />
      )}
      <Text size="xs" className="quiet">
        {stateText(job)}
      </Text>
    </Group>
  );
}

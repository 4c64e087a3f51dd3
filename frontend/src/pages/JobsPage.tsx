import { Button, Group, Progress, Select, Text } from "@mantine/core";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useCancelJob } from "../api/commands";
import { jobsQuery, maneuversQuery, runsQuery } from "../api/queries";
import { isOver, STATES, type Job } from "../api/types";
import { DataTable, type Column } from "../components/DataTable";
import { Empty } from "../components/Empty";
import { Loaded } from "../components/Loaded";
import { PageHead } from "../components/PageHead";
import { ProblemAlert } from "../components/ProblemAlert";
import { StateBadge } from "../components/RunBadge";
import { dateTime, elapsed } from "../lib/format";

const route = getRouteApi("/jobs");

/** What runs, what waits, what is over. */
export function JobsPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const jobs = useQuery(jobsQuery(view.state));
  const runs = useQuery(runsQuery({}));
  const cancel = useCancelJob();
  const runOf = new Map((runs.data ?? []).map((run) => [run.id, run]));

  const maneuvers = useInfiniteQuery(maneuversQuery({}, "id", 1000));
  const labels = new Map(
    maneuvers.data?.pages.flatMap((page) => page.items.map((one) => [one.id, one.label])),
  );

  const columns: Column<Job>[] = [
    {
      key: "run",
      header: "Run",
      render: (job) => (
        <Link to="/runs/$id" params={{ id: job.run_id }} className="link">
          {runOf.get(job.run_id)?.method ?? ""} run {job.run_id}
        </Link>
      ),
    },
    {
      key: "maneuver",
      header: "Maneuver",
      render: (job) => {
        const id = runOf.get(job.run_id)?.maneuver_id;
        return id === undefined ? (
          ""
        ) : (
          <Link to="/maneuvers/$id" params={{ id }} className="link">
            {labels.get(id) ?? `Maneuver ${id}`}
          </Link>
        );
      },
    },
    { key: "state", header: "State", render: (job) => <StateBadge state={job.state} /> },
    { key: "progress", header: "Progress", render: (job) => <JobState job={job} /> },
    {
      key: "took",
      header: "Took",
      numeric: true,
      render: (job) => elapsed(job.started_at, job.finished_at),
    },
    {
      key: "at",
      header: "Requested",
      numeric: true,
      render: (job) => dateTime(job.created_at),
    },
    {
      key: "cancel",
      header: "",
      render: (job) =>
        !isOver(job.state) && (
          <Button
            variant="default"
            size="compact-xs"
            onClick={() => {
              cancel.mutate(job.id);
            }}
          >
            Cancel
          </Button>
        ),
    },
  ];

  return (
    <>
      <PageHead
        title="Jobs"
        trail={[
          <Link to="/" className="link" key="campaign">
            Campaign
          </Link>,
        ]}
        actions={
          <Select
            aria-label="State"
            placeholder="Any state"
            clearable
            w={140}
            data={[...STATES]}
            value={view.state ?? null}
            onChange={(state) =>
              void navigate({ search: { state: STATES.find((one) => one === state) } })
            }
          />
        }
      />
      {cancel.isError && <ProblemAlert error={cancel.error} />}
      <div className="panel">
        <Loaded query={jobs} rows={10}>
          {(rows) =>
            rows.length === 0 ? (
              <Empty title={view.state ? `No job is ${view.state}` : "No jobs yet"}>
                A job appears here when a run is submitted from a maneuver.
              </Empty>
            ) : (
              <DataTable
                label="Jobs"
                testId="jobs-table"
                columns={columns}
                rows={rows}
                rowKey={(job) => job.id}
              />
            )
          }
        </Loaded>
      </div>
    </>
  );
}

function JobState({ job }: { job: Job }) {
  if (job.state === "failed") {
    return (
      <Text size="sm" truncate maw={420} title={job.error?.message}>
        {job.error?.message ?? ""}
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

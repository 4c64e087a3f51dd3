import { Button, Select, Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useRequestBackup } from "../api/commands";
import { batchesQuery, jobsQuery, queueQuery } from "../api/queries";
import { STATES, type Batch } from "../api/types";
import { BatchBar, left, total } from "../components/jobs/BatchBar";
import { DataTable, type Column } from "../components/controls/DataTable";
import { Empty } from "../components/display/Empty";
import { JobTable } from "../components/jobs/JobTable";
import { JobWait } from "../components/jobs/JobWait";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { QueueStatus } from "../components/frame/QueueStatus";
import { Section } from "../components/display/Section";
import { dateTime, elapsed } from "../lib/text/format";

const route = getRouteApi("/jobs");

const BATCHES: Column<Batch>[] = [
  {
    key: "name",
    header: "Batch",
    render: ({ batch }) => (
      <Link to="/batches/$id" params={{ id: batch.id }} className="link">
        {batch.name}
      </Link>
    ),
  },
  { key: "runs", header: "Runs", numeric: true, render: total },
  { key: "left", header: "Remaining", numeric: true, render: left },
  { key: "failed", header: "Failed", numeric: true, render: ({ states }) => states.failed ?? 0 },
  {
    key: "bar",
    header: "Progress",
    render: (batch) => (
      <div style={{ width: 220 }}>
        <BatchBar batch={batch} />
      </div>
    ),
  },
  {
    key: "took",
    header: "Duration",
    numeric: true,
    render: (batch) => elapsed(batch.started_at, batch.finished_at),
  },
  { key: "author", header: "By", render: ({ batch }) => batch.author },
  {
    key: "at",
    header: "Requested",
    numeric: true,
    render: ({ batch }) => dateTime(batch.created_at),
  },
];

/** Queue, batches and jobs of all kinds. */
export function JobsPage() {
  const { state } = route.useSearch();
  const navigate = route.useNavigate();
  const queue = useQuery(queueQuery);
  const batches = useQuery(batchesQuery);
  const jobs = useQuery(jobsQuery({ state }));
  const backup = useRequestBackup();
  return (
    <>
      <PageHead
        title="Jobs"
        actions={
          <Button
            variant="default"
            data-testid="back-up"
            loading={backup.isPending}
            onClick={() => {
              backup.mutate();
            }}
          >
            Back up database
          </Button>
        }
      />
      <Stack gap="md">
        {backup.isError && <ProblemAlert error={backup.error} />}
        {backup.data !== undefined && <JobWait id={backup.data.id} />}
        <Section title="Queue">
          <Loaded query={queue} rows={2}>
            {(status) => <QueueStatus status={status} />}
          </Loaded>
        </Section>
        {batches.data !== undefined && batches.data.length > 0 && (
          <Section title="Batches">
            <DataTable
              label="Batches"
              testId="batches-table"
              columns={BATCHES}
              rows={batches.data}
              rowKey={({ batch }) => batch.id}
              maxHeight={320}
            />
          </Section>
        )}
        <Section
          title="Jobs"
          note="Newest 100"
          actions={
            <Select
              aria-label="State"
              placeholder="Any state"
              clearable
              w={140}
              data={[...STATES]}
              value={state ?? null}
              onChange={(value) =>
                void navigate({ search: { state: STATES.find((one) => one === value) } })
              }
            />
          }
        >
          <Loaded query={jobs} rows={10}>
            {(rows) =>
              rows.length === 0 ? (
                <Empty title={state ? `No jobs in state ${state}` : "No jobs yet"}>
                  Submit a run from a maneuver.
                </Empty>
              ) : (
                <JobTable jobs={rows} />
              )
            }
          </Loaded>
        </Section>
      </Stack>
    </>
  );
}

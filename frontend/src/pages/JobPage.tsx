import { Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { jobLogQuery, jobQuery } from "../api/queries";
import type { JobEvent } from "../api/types";
import { DataTable, type Column } from "../components/controls/DataTable";
import { JobTable } from "../components/jobs/JobTable";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { StateBadge } from "../components/runs/RunBadge";
import { Section } from "../components/display/Section";
import { dateTime } from "../lib/text/format";

const route = getRouteApi("/jobs/$id");

const COLUMNS: Column<JobEvent>[] = [
  { key: "at", header: "When", render: (line) => dateTime(line.at) },
  { key: "kind", header: "Event", render: (line) => line.kind },
  { key: "attempt", header: "Attempt", numeric: true, render: (line) => line.attempt || "–" },
  { key: "message", header: "Detail", wraps: true, render: (line) => line.message },
];

/** Log of a job. */
export function JobPage() {
  const { id } = route.useParams();
  const job = useQuery(jobQuery(id));
  const log = useQuery(jobLogQuery(id));
  return (
    <Loaded query={job} page={`Job ${id}`}>
      {(data) => (
        <>
          <PageHead
            title={`Job ${id}`}
            trail={[
              <Link to="/jobs" className="link" key="jobs">
                Jobs
              </Link>,
            ]}
            aside={<StateBadge state={data.state} />}
          />
          <Stack gap="md">
            <div className="panel">
              <JobTable jobs={[data]} />
            </div>
            <Section title="Log" note={data.worker === null ? undefined : `worker ${data.worker}`}>
              <Loaded query={log}>
                {(lines) => (
                  <DataTable
                    label="Log"
                    testId="job-log"
                    columns={COLUMNS}
                    rows={lines}
                    rowKey={(line) => line.id}
                  />
                )}
              </Loaded>
            </Section>
          </Stack>
        </>
      )}
    </Loaded>
  );
}

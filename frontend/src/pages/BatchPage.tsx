import { Button, Select, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useChangeBatch } from "../api/commands";
import { batchQuery, jobsQuery } from "../api/queries";
import { STATES } from "../api/types";
import { BatchBar, left, total } from "../components/jobs/BatchBar";
import { ButtonLink } from "../components/controls/ButtonLink";
import { Empty } from "../components/display/Empty";
import { JobTable } from "../components/jobs/JobTable";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { PredictLinks } from "../components/runs/PredictLinks";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { Section } from "../components/display/Section";
import { dateTime, elapsed } from "../lib/text/format";

const route = getRouteApi("/batches/$id");

/** Progress and results of the runs of a batch. */
export function BatchPage() {
  const { id } = route.useParams();
  const { state } = route.useSearch();
  const navigate = route.useNavigate();
  const batch = useQuery(batchQuery(id));
  const jobs = useQuery(jobsQuery({ batch_id: id, state }));
  const cancel = useChangeBatch(id, "cancel");
  const retry = useChangeBatch(id, "retry");
  return (
    <Loaded query={batch} page={`Batch ${id}`}>
      {(data) => {
        const again = (data.states.failed ?? 0) + (data.states.cancelled ?? 0);
        const done = (jobs.data ?? []).filter((job) => job.state === "succeeded");
        return (
          <>
            <PageHead
              title={data.batch.name}
              trail={[
                <Link to="/jobs" className="link" key="jobs">
                  Jobs
                </Link>,
              ]}
              actions={
                <>
                  {done.length > 1 && (
                    <ButtonLink
                      variant="default"
                      to="/compare"
                      search={{ runs: done.slice(0, 12).map((job) => job.id) }}
                    >
                      Compare {Math.min(done.length, 12)}
                    </ButtonLink>
                  )}
                  <PredictLinks runs={done.map((job) => job.id)} />
                  {again > 0 && (
                    <Button
                      variant="default"
                      loading={retry.isPending}
                      data-testid="retry-batch"
                      onClick={() => {
                        retry.mutate();
                      }}
                    >
                      Retry {again}
                    </Button>
                  )}
                  {left(data) > 0 && (
                    <Button
                      variant="default"
                      loading={cancel.isPending}
                      data-testid="cancel-batch"
                      onClick={() => {
                        cancel.mutate();
                      }}
                    >
                      Cancel {left(data)}
                    </Button>
                  )}
                </>
              }
            />
            {cancel.isError && <ProblemAlert error={cancel.error} />}
            {retry.isError && <ProblemAlert error={retry.error} />}
            <Stack gap="md">
              <Section
                title="Progress"
                note={
                  data.started_at === null
                    ? "not started"
                    : data.finished_at === null
                      ? `started ${dateTime(data.started_at)}`
                      : `duration ${elapsed(data.started_at, data.finished_at)}`
                }
              >
                <BatchBar batch={data} words />
              </Section>
              <Section
                title="Runs"
                note={total(data) > 100 ? "Newest 100 in this state" : undefined}
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
                <Loaded query={jobs} rows={8}>
                  {(rows) =>
                    rows.length === 0 ? (
                      <Empty title="No runs in this state" />
                    ) : (
                      <JobTable jobs={rows} />
                    )
                  }
                </Loaded>
              </Section>
              <Text size="xs" className="quiet">
                Runs requested before are reused; they are not computed twice.
              </Text>
            </Stack>
          </>
        );
      }}
    </Loaded>
  );
}

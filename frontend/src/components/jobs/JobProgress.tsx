import { Button, Group, Progress, Text } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { useCancelJob } from "../../api/commands";
import { jobQuery, runQuery } from "../../api/queries";
import { isOver } from "../../api/types";
import { significant } from "../../lib/text/format";
import { ProblemAlert } from "../display/ProblemAlert";
import { UsualTime } from "./JobWait";

/** Follows a job until it is over; its run is read again whenever the state changes. */
export function JobProgress({ id }: { id: number }) {
  const job = useQuery(jobQuery(id));
  const cancel = useCancelJob();
  const cache = useQueryClient();
  const state = job.data?.state;
  const over = state !== undefined && isOver(state);
  useEffect(() => {
    void cache.invalidateQueries({ queryKey: runQuery(id).queryKey });
  }, [state, cache, id]);
  useEffect(() => {
    if (!over) return;
    void cache.invalidateQueries({ queryKey: ["runs"] });
    void cache.invalidateQueries({ queryKey: ["maneuvers"] });
  }, [over, cache, id]);

  const progress = job.data?.progress;
  const fraction = 100 * (progress?.fraction ?? 0);
  return (
    <div data-testid="job-progress">
      {job.isError && <ProblemAlert error={job.error} onRetry={() => void job.refetch()} />}
      <Group justify="space-between" mb={6}>
        <Text size="sm" className="numbers" aria-live="polite">
          {job.data?.state === "queued" && "Waiting for a worker"}
          {job.data?.state === "running" && (
            <>
              {progress?.message === "" ? "Estimating" : (progress?.message ?? "Starting")}
              {progress && progress.iteration > 0 && `, iteration ${progress.iteration}`}
              {progress?.cost != null && `, cost ${significant(progress.cost, 6)}`}
              <UsualTime kind={job.data.kind} />
            </>
          )}
        </Text>
        <Button
          variant="default"
          disabled={over}
          loading={cancel.isPending}
          data-testid="cancel-run"
          onClick={() => {
            cancel.mutate(id);
          }}
        >
          Cancel
        </Button>
      </Group>
      <Progress
        value={job.data?.state === "running" ? Math.max(3, fraction) : 0}
        animated={job.data?.state === "running"}
        aria-label="Progress"
      />
      {cancel.isError && <ProblemAlert error={cancel.error} />}
    </div>
  );
}

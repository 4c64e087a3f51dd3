import { Alert, Button, Group, Progress, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useEffect } from "react";
import { useCancelTask } from "../api/commands";
import { taskQuery } from "../api/queries";
import type { Task } from "../api/types";
import { ProblemAlert } from "./ProblemAlert";

interface Props {
  task: Task;
  /** Called once with the id of the created record. */
  onMade?: (made: number) => void;
  /** Called once when the task is done, with or without a created record. */
  onDone?: () => void;
}

/** Progress of a task, with a button to cancel it. */
export function TaskProgress({ task, onMade, onDone }: Props) {
  const now = useQuery(taskQuery(task));
  const cancel = useCancelTask();
  const state = now.data.state;
  const made = now.data.result_id;
  const goesOn = state === "waiting" || state === "running";
  useEffect(() => {
    if (state !== "done") return;
    onDone?.();
    if (made !== null) onMade?.(made);
    // Once for each task that is done, however often the page is drawn.
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [state, made, task.id]);
  return (
    <div data-testid="task-progress">
      {now.isError && <ProblemAlert error={now.error} />}
      {state === "failed" && (
        <Alert color="red" variant="light" title="Nothing was stored">
          {now.data.message}
        </Alert>
      )}
      {state === "cancelled" && (
        <Alert color="yellow" variant="light">
          Cancelled; nothing was stored.
        </Alert>
      )}
      {goesOn && !now.isError && (
        <>
          <Group justify="space-between" mb={6}>
            <Text size="sm" className="numbers" aria-live="polite">
              {state === "waiting" ? "Queued" : now.data.message}
            </Text>
            <Button
              variant="default"
              size="compact-sm"
              loading={cancel.isPending}
              onClick={() => {
                cancel.mutate(task.id);
              }}
            >
              Cancel
            </Button>
          </Group>
          <Progress
            value={Math.max(3, 100 * now.data.fraction)}
            animated={state === "running"}
            aria-label="Progress"
          />
        </>
      )}
    </div>
  );
}

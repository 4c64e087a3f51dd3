import { Group, Progress, Text } from "@mantine/core";
import type { Batch } from "../../api/types";

const PARTS = [
  { state: "succeeded", color: "teal", word: "succeeded" },
  { state: "running", color: "blue", word: "running" },
  { state: "failed", color: "red", word: "failed" },
  { state: "cancelled", color: "gray", word: "cancelled" },
] as const;

/** How many runs of a batch there are. */
export const total = ({ states }: Batch) => Object.values(states).reduce((sum, n) => sum + n, 0);

/** Number of runs not yet ended. */
export const left = ({ states }: Batch) => (states.queued ?? 0) + (states.running ?? 0);

/** Progress of the runs of a batch, as a bar and as text. */
export function BatchBar({ batch, words = false }: { batch: Batch; words?: boolean }) {
  const all = total(batch);
  const summary = [
    ...PARTS.filter(({ state }) => (batch.states[state] ?? 0) > 0).map(
      ({ state, word }) => `${batch.states[state]} ${word}`,
    ),
    ...((batch.states.queued ?? 0) > 0 ? [`${batch.states.queued} queued`] : []),
  ].join(", ");
  return (
    <div>
      <Progress.Root size={words ? 14 : 8} aria-label={`${summary} of ${all}`}>
        {PARTS.map(({ state, color }) => (
          <Progress.Section
            key={state}
            value={all > 0 ? (100 * (batch.states[state] ?? 0)) / all : 0}
            color={color}
            aria-label={`${batch.states[state] ?? 0} ${state}`}
          />
        ))}
      </Progress.Root>
      {words && (
        <Group mt={6}>
          <Text size="sm" className="numbers" aria-live="polite" data-testid="batch-states">
            {summary} of {all}
          </Text>
        </Group>
      )}
    </div>
  );
}

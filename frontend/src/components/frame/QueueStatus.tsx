import { Group, Stack, Text } from "@mantine/core";
import type { QueueStatus as Status } from "../../api/types";
import { duration } from "../../lib/text/format";

/** State of the queue: workers, throughput, estimated completion. */
export function QueueStatus({ status }: { status: Status }) {
  const { worker_pool: pool, states } = status;
  const perMinute = (60 * status.ended) / status.window_s;
  // The dispatcher reports its runs every few seconds; the states are current.
  const busy = Math.min(states.running ?? 0, pool?.workers ?? 0);
  return (
    <Group gap="xl" className="numbers" data-testid="queue-status">
      <Fact label="Waiting" value={String(states.queued ?? 0)} />
      <Fact label="Running" value={String(states.running ?? 0)} />
      <Fact
        label="Workers"
        value={pool === null ? "none" : `${busy} of ${pool.workers} busy`}
        note={pool === null ? "no dispatcher" : `${pool.location}, led by ${pool.server}`}
      />
      <Fact
        label="Throughput"
        value={status.ended > 0 ? `${perMinute.toFixed(perMinute < 10 ? 1 : 0)} per min` : "–"}
      />
      <Fact
        label="Estimated completion"
        value={
          status.remaining_s === null || status.remaining_s <= 0
            ? "–"
            : duration(status.remaining_s)
        }
      />
    </Group>
  );
}

function Fact({ label, value, note }: { label: string; value: string; note?: string }) {
  return (
    <Stack gap={0}>
      <Text size="xs" className="quiet">
        {label}
      </Text>
      <Text fw={600}>{value}</Text>
      {note !== undefined && (
        <Text size="xs" className="quiet">
          {note}
        </Text>
      )}
    </Stack>
  );
}

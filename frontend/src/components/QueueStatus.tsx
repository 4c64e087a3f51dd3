import { Group, Stack, Text } from "@mantine/core";
import type { QueueStatus as Status } from "../api/types";
import { duration } from "../lib/format";

/** How the queue goes: who works, how fast, until when. */
export function QueueStatus({ status }: { status: Status }) {
  const { crew, states } = status;
  const perMinute = (60 * status.ended) / status.window_s;
  // The crew tells which runs it has every few seconds; the states are of this moment.
  const busy = Math.min(states.running ?? 0, crew?.workers ?? 0);
  return (
    <Group gap="xl" className="numbers" data-testid="queue-status">
      <Fact label="Waiting" value={String(states.queued ?? 0)} />
      <Fact label="Running" value={String(states.running ?? 0)} />
      <Fact
        label="Workers"
        value={crew === null ? "none" : `${busy} of ${crew.workers} busy`}
        note={crew === null ? "no server leads the queue" : `${crew.place}, led by ${crew.server}`}
      />
      <Fact
        label="Throughput"
        value={status.ended > 0 ? `${perMinute.toFixed(perMinute < 10 ? 1 : 0)} per min` : "–"}
      />
      <Fact
        label="Empty in about"
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

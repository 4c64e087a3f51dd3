import { Button, Group, Progress, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import type { ReactNode } from "react";
import { useAssess, useCancelTask } from "../api/commands";
import { assessingQuery, importsQuery, tasksQuery } from "../api/queries";
import type { Task } from "../api/types";
import { count, dateMinute, elapsed } from "../lib/format";
import { DataTable, type Column } from "./DataTable";
import { Section } from "./Section";

interface Work {
  key: string;
  what: ReactNode;
  state: string;
  fraction: number | null;
  took: string;
  at: string;
  stop?: ReactNode;
}

const COLUMNS: Column<Work>[] = [
  { key: "what", header: "Job", yields: true, render: (one) => one.what },
  { key: "state", header: "State", wraps: true, render: (one) => one.state },
  {
    key: "progress",
    header: "Progress",
    render: (one) =>
      one.fraction !== null && (
        <Progress value={100 * one.fraction} w={160} aria-label={`Progress of ${one.key}`} />
      ),
  },
  { key: "took", header: "Duration", numeric: true, render: (one) => one.took },
  { key: "at", header: "Started", numeric: true, render: (one) => one.at },
  { key: "stop", header: "", render: (one) => one.stop },
];

/** What goes on beside the runs: designs, pre-flight simulations, flutter, imports, the look at a campaign. */
export function TaskTable() {
  const tasks = useQuery(tasksQuery).data ?? [];
  const imports = useQuery(importsQuery).data ?? [];
  const looking = useQuery(assessingQuery).data;
  const assess = useAssess();
  const rows: Work[] = [];
  if (looking?.running === true) {
    rows.push({
      key: "looking",
      what: (
        <Link to="/quality" className="link">
          Quality check of the campaign
        </Link>
      ),
      state: `${looking.done} of ${count(looking.total, "maneuver")}`,
      fraction: looking.total > 0 ? looking.done / looking.total : 0,
      took: "",
      at: "",
      stop: (
        <Stop
          of="the quality check"
          busy={assess.isPending}
          onStop={() => {
            assess.mutate("stop");
          }}
        />
      ),
    });
  }
  for (const one of imports) {
    rows.push({
      key: one.id,
      what: (
        <Link to="/import" search={{ upload: one.id }} className="link">
          Import
        </Link>
      ),
      state: "writing",
      fraction: one.progress ?? 0,
      took: "",
      at: "",
    });
  }
  for (const task of tasks) rows.push(work(task));
  if (rows.length === 0) return null;
  return (
    <Section title="Other jobs" note="Since the server started">
      <DataTable
        label="Other jobs"
        testId="beside-table"
        columns={COLUMNS}
        rows={rows}
        rowKey={(one) => one.key}
        maxHeight={320}
      />
    </Section>
  );
}

const KINDS: Record<string, string> = {
  design: "Design",
  "preflight-simulation": "Pre-flight simulation",
  flutter: "Flutter prediction",
  "closed-loop": "Closed loop",
};

function work(task: Task): Work {
  const goesOn = task.state === "waiting" || task.state === "running";
  const state = task.state === "done" || task.message === "" ? task.state : task.message;
  return {
    key: task.id,
    what: (
      <Group gap={6} wrap="nowrap">
        <Text size="sm" className="quiet">
          {KINDS[task.kind] ?? task.kind}
        </Text>
        {task.kind === "design" && task.result_id !== null ? (
          <Link to="/excitation/$id" params={{ id: task.result_id }} className="link">
            {task.title}
          </Link>
        ) : (
          task.title
        )}
      </Group>
    ),
    state,
    fraction: goesOn ? task.fraction : null,
    took: elapsed(task.begun_at, task.ended_at),
    at: dateMinute(task.begun_at),
    stop: goesOn && <StopTask task={task} />,
  };
}

function StopTask({ task }: { task: Task }) {
  const cancel = useCancelTask();
  return (
    <Stop
      of={task.title}
      busy={cancel.isPending}
      onStop={() => {
        cancel.mutate(task.id);
      }}
    />
  );
}

function Stop({ of, busy, onStop }: { of: string; busy: boolean; onStop: () => void }) {
  return (
    <Button
      variant="default"
      size="compact-xs"
      aria-label={`Cancel ${of}`}
      loading={busy}
      onClick={onStop}
    >
      Cancel
    </Button>
  );
}

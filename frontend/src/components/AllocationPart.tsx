import { Button, Group, NumberInput, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useNavigate } from "@tanstack/react-router";
import { useRescaleDesign } from "../api/commands";
import { allocationQuery } from "../api/queries";
import type { AllocatedError, AllocatedPeak, Allocation, Design } from "../api/types";
import { degrees, fixed } from "../lib/format";
import { DataTable, type Column } from "./DataTable";
import { DerivativeName } from "./DerivativeName";
import { Loaded } from "./Loaded";
import { ProblemAlert } from "./ProblemAlert";

const LOAD_FACTOR = "load factor";
const WAYS = [
  ["flat", "As designed"],
  ["minimax", "Least worst error"],
  ["d_optimal", "D-optimal"],
] as const;
type Way = (typeof WAYS)[number][0];

const shown = (row: AllocatedPeak, value: number | null) =>
  value === null ? "" : row.name === LOAD_FACTOR ? fixed(value, 3) : fixed(degrees(value), 2);

const COMMANDS: Column<AllocatedPeak>[] = [
  { key: "name", header: "Command", render: (row) => row.name },
  ...WAYS.map(([way, header]) => ({
    key: way,
    header,
    unit: "deg",
    numeric: true,
    render: (row: AllocatedPeak) => shown(row, row[way]),
  })),
];

const LIMITED: Column<AllocatedPeak>[] = [
  {
    key: "name",
    header: "Largest",
    render: (row) => (row.name === LOAD_FACTOR ? "load factor [g]" : `${row.name} [deg]`),
  },
  { key: "limit", header: "Limit", numeric: true, render: (row) => shown(row, row.limit) },
  ...WAYS.map(([way, header]) => ({
    key: way,
    header,
    numeric: true,
    render: (row: AllocatedPeak) => shown(row, row[way]),
  })),
];

const ERRORS: Column<AllocatedError>[] = [
  { key: "name", header: "Derivative", render: (row) => <DerivativeName name={row.name} /> },
  ...WAYS.map(([way, header]) => ({
    key: way,
    header: `σ, ${header.charAt(0) === "D" ? header : header.toLowerCase()}`,
    unit: "%",
    numeric: true,
    render: (row: AllocatedError) => fixed(100 * row[way], 1),
  })),
  {
    key: "counts",
    header: "Decides",
    render: (row) => (row.counts ? "" : "no: not clear of its error in the run"),
  },
];

interface Props {
  design: Design;
  level: number;
  run: number;
  /** Limits as typed [deg], [g]. */
  allowed: number | undefined;
  load: number | undefined;
  onChange: (part: { allowed?: number; load?: number }) => void;
}

/** Amplitudes that would tell more within the same limits, beside those of the design. */
export function AllocationPart({ design, level, run, allowed, load, onChange }: Props) {
  const found = useQuery(
    allocationQuery(design.id, level, run, {
      deflection: allowed === undefined ? undefined : (allowed * Math.PI) / 180,
      load_factor: load,
    }),
  );
  return (
    <Stack gap="sm">
      <Group align="end">
        <NumberInput
          label="Deflection limit [deg]"
          placeholder="the design's own"
          min={0.01}
          w={190}
          value={allowed ?? ""}
          onChange={(next) => {
            onChange({ allowed: typeof next === "number" && next > 0 ? next : undefined });
          }}
        />
        <NumberInput
          label="Load factor limit [g]"
          placeholder="the design's own"
          min={0.001}
          w={190}
          value={load ?? ""}
          onChange={(next) => {
            onChange({ load: typeof next === "number" && next > 0 ? next : undefined });
          }}
        />
      </Group>
      <Loaded query={found} rows={12}>
        {(allocation) => <Found design={design} run={run} allocation={allocation} />}
      </Loaded>
    </Stack>
  );
}

function Found({
  design,
  run,
  allocation,
}: {
  design: Design;
  run: number;
  allocation: Allocation;
}) {
  const rescale = useRescaleDesign(design.id);
  const navigate = useNavigate();
  const keep = (way: Exclude<Way, "flat">, words: string) => {
    rescale.mutate(
      {
        name: `${design.name}, ${words}`,
        gains: allocation.gains[way] ?? {},
        note: `Amplitudes of ${design.name} allotted for run ${run}`,
      },
      {
        onSuccess: (kept) =>
          void navigate({ to: "/excitation/$id", params: { id: kept.id }, search: { run } }),
      },
    );
  };
  const counted = allocation.errors.filter((row) => row.counts);
  const worst = (way: Way) => fixed(100 * Math.max(...counted.map((row) => row[way])), 1);
  return (
    <>
      {rescale.isError && <ProblemAlert error={rescale.error} />}
      <Group justify="space-between">
        <Text size="sm" data-testid="allocation-worst">
          Worst relative error of {counted.length} derivatives: {worst("flat")} % as designed,{" "}
          {worst("minimax")} % with the least worst error, {worst("d_optimal")} % D-optimal.
        </Text>
        <Group gap="xs" className="no-print">
          <Button
            variant="default"
            size="xs"
            loading={rescale.isPending}
            onClick={() => {
              keep("minimax", "least worst error");
            }}
          >
            Keep the least worst error
          </Button>
          <Button
            variant="default"
            size="xs"
            loading={rescale.isPending}
            onClick={() => {
              keep("d_optimal", "D-optimal");
            }}
          >
            Keep D-optimal
          </Button>
        </Group>
      </Group>
      <Group align="start" gap="xl" wrap="wrap">
        <div>
          <DataTable
            label="Commands"
            testId="allocation-commands"
            columns={COMMANDS}
            rows={allocation.commands}
            rowKey={(row) => row.name}
          />
        </div>
        <div>
          <DataTable
            label="What is limited"
            testId="allocation-limited"
            columns={LIMITED}
            rows={allocation.limited}
            rowKey={(row) => row.name}
          />
        </div>
      </Group>
      <DataTable
        label="Relative standard errors"
        testId="allocation-errors"
        columns={ERRORS}
        rows={allocation.errors}
        rowKey={(row) => row.name}
        maxHeight={420}
      />
    </>
  );
}

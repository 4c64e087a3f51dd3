import { Button, Group, Stack, Text } from "@mantine/core";
import { useNavigate } from "@tanstack/react-router";
import { useRescaleDesign } from "../../api/commands";
import { storedResult } from "../../api/storedResult";
import type { OptimisedError, OptimisedPeak, OptimisedAmplitudes, Design } from "../../api/types";
import { degrees, fixed } from "../../lib/text/format";
import { ComputedResult } from "../display/ComputedResult";
import { DataTable, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { NumberField } from "../controls/NumberField";
import { ProblemAlert } from "../display/ProblemAlert";
import { quantity } from "../display/Quantity";

const LOAD_FACTOR = "load factor";
const WAYS = [
  ["flat", "As designed"],
  ["minimax", "Minimax error"],
  ["d_optimal", "D-optimal"],
] as const;
type Way = (typeof WAYS)[number][0];

const shown = (row: OptimisedPeak, value: number | null) =>
  value === null ? "" : row.name === LOAD_FACTOR ? fixed(value, 3) : fixed(degrees(value), 2);

const COMMANDS: Column<OptimisedPeak>[] = [
  { key: "name", header: "Command", render: (row) => row.name },
  ...WAYS.map(([way, header]) => ({
    key: way,
    header,
    unit: "deg",
    numeric: true,
    render: (row: OptimisedPeak) => shown(row, row[way]),
  })),
];

const LIMITED: Column<OptimisedPeak>[] = [
  {
    key: "name",
    header: "Peak",
    render: (row) => (row.name === LOAD_FACTOR ? "load factor [g]" : `${row.name} [deg]`),
  },
  { key: "limit", header: "Limit", numeric: true, render: (row) => shown(row, row.limit) },
  ...WAYS.map(([way, header]) => ({
    key: way,
    header,
    numeric: true,
    render: (row: OptimisedPeak) => shown(row, row[way]),
  })),
];

const ERRORS: Column<OptimisedError>[] = [
  { key: "name", header: "Derivative", render: (row) => <DerivativeName name={row.name} /> },
  ...WAYS.map(([way, header]) => ({
    key: way,
    header: `σ, ${header.charAt(0) === "D" ? header : header.toLowerCase()}`,
    unit: "%",
    numeric: true,
    render: (row: OptimisedError) => fixed(100 * row[way], 1),
  })),
  {
    key: "counts",
    header: "In criterion",
    render: (row) => (row.counts ? "" : "no: insignificant in the run"),
  },
];

type AmplitudeLevel = OptimisedAmplitudes["levels"][number];

const LEVELS: Column<AmplitudeLevel>[] = [
  quantity("airspeed", "Airspeed", (row) => row.airspeed_m_s, "m/s", 1),
  {
    key: "ratio",
    header: (
      <>
        V/V<sub>f</sub>
      </>
    ),
    numeric: true,
    render: (row) => (row.airspeed_ratio === null ? "–" : fixed(row.airspeed_ratio, 2)),
  },
  {
    key: "largest",
    header: "Largest amplitude",
    unit: "deg",
    numeric: true,
    render: (row) => fixed(degrees(row.largest), 2),
  },
  { key: "limit", header: "Limited by", render: (row) => row.limited_by.replace("_", " ") },
  {
    key: "ratio-of-noise",
    header: "Signal-to-noise ratio there",
    numeric: true,
    render: (row) => fixed(row.signal_to_noise, 1),
  },
  {
    key: "least",
    header: "Amplitude of ratio 10",
    unit: "deg",
    numeric: true,
    render: (row) =>
      row.least <= row.largest ? fixed(degrees(row.least), 2) : "beyond the limits",
  },
];

interface Props {
  design: Design;
  level: number;
  run: number;
  /** Limits as typed [deg], [deg/s], [g]. */
  allowed: number | undefined;
  fastest: number | undefined;
  load: number | undefined;
  onChange: (part: {
    allowed?: number | undefined;
    fastest?: number | undefined;
    load?: number | undefined;
  }) => void;
}

/** Amplitude optimisation within the same limits, compared with the design. */
export function AmplitudesPart({ design, level, run, allowed, fastest, load, onChange }: Props) {
  const query = {
    run_id: run,
    level,
    deflection: allowed === undefined ? undefined : (allowed * Math.PI) / 180,
    rate: fastest === undefined ? undefined : (fastest * Math.PI) / 180,
    load_factor: load,
  };
  const path = { design_id: design.id };
  const options = storedResult("/api/v1/designs/{design_id}/amplitudes", { path, query });
  return (
    <Stack gap="sm">
      <Group align="end">
        <NumberField
          label="Deflection limit"
          unit="deg"
          placeholder="limit of the design"
          isPositive
          w={190}
          value={allowed}
          onChange={(next) => {
            onChange({ allowed: next });
          }}
        />
        <NumberField
          label="Rate limit"
          description="of the amplitudes by airspeed"
          unit="deg/s"
          placeholder="limit of the design"
          isPositive
          w={190}
          value={fastest}
          onChange={(next) => {
            onChange({ fastest: next });
          }}
        />
        <NumberField
          label="Load factor limit"
          unit="g"
          placeholder="limit of the design"
          isPositive
          w={190}
          value={load}
          onChange={(next) => {
            onChange({ load: next });
          }}
        />
      </Group>
      <ComputedResult options={options} rows={12}>
        {(result) => <Found design={design} run={run} result={result} />}
      </ComputedResult>
    </Stack>
  );
}

function Found({
  design,
  run,
  result,
}: {
  design: Design;
  run: number;
  result: OptimisedAmplitudes;
}) {
  const rescale = useRescaleDesign(design.id);
  const navigate = useNavigate();
  const save = (way: Exclude<Way, "flat">, words: string) => {
    rescale.mutate(
      {
        name: `${design.name}, ${words}`,
        gains: result.gains[way] ?? {},
        note: `Amplitudes of ${design.name} optimised for run ${run}`,
      },
      {
        onSuccess: (stored) =>
          void navigate({ to: "/excitation/$id", params: { id: stored.id }, search: { run } }),
      },
    );
  };
  const counted = result.errors.filter((row) => row.counts);
  const worst = (way: Way) => fixed(100 * Math.max(...counted.map((row) => row[way])), 1);
  return (
    <>
      {rescale.isError && <ProblemAlert error={rescale.error} />}
      <Group justify="space-between">
        <Text size="sm" data-testid="amplitudes-worst">
          Worst relative error of {counted.length} derivatives: {worst("flat")} % as designed,{" "}
          {worst("minimax")} % with minimax error, {worst("d_optimal")} % D-optimal.
        </Text>
        <Group gap="xs" className="no-print">
          <Button
            variant="default"
            size="xs"
            loading={rescale.isPending}
            onClick={() => {
              save("minimax", "minimax error");
            }}
          >
            Save minimax design
          </Button>
          <Button
            variant="default"
            size="xs"
            loading={rescale.isPending}
            onClick={() => {
              save("d_optimal", "D-optimal");
            }}
          >
            Save D-optimal design
          </Button>
        </Group>
      </Group>
      <Group align="start" gap="xl" wrap="wrap">
        <div>
          <DataTable
            label="Commands"
            testId="amplitudes-commands"
            columns={COMMANDS}
            rows={result.commands}
            rowKey={(row) => row.name}
          />
        </div>
        <div>
          <DataTable
            label="Limited quantities"
            testId="amplitudes-limited"
            columns={LIMITED}
            rows={result.limited}
            rowKey={(row) => row.name}
          />
        </div>
      </Group>
      <DataTable
        label="Relative standard errors"
        testId="amplitudes-errors"
        columns={ERRORS}
        rows={result.errors}
        rowKey={(row) => row.name}
        maxHeight={420}
      />
      {result.levels.length > 0 && (
        <div>
          <Text size="sm" fw={600}>
            Amplitude of the design by airspeed
          </Text>
          <Text size="sm" className="quiet">
            Within the limits, below the flutter speed of the run. Derivatives, weight, noise and
            the response of the surfaces are those of the run.
          </Text>
          <DataTable
            label="Amplitude by airspeed"
            testId="amplitudes-levels"
            columns={LEVELS}
            rows={result.levels}
            rowKey={(row) => String(row.airspeed_m_s)}
          />
        </div>
      )}
    </>
  );
}

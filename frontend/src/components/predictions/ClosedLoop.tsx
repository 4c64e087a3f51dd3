import { Alert, Group, Stack } from "@mantine/core";
import { closedLoopResult, type FlutterParams } from "../../api/queries";
import type { ClosedLoopStability, MarginRow, ReviewedGlobalModel } from "../../api/types";
import { useStoredResult } from "../../api/useStoredResult";
import { ApprovedModelNote } from "../new-run/ApprovedModelNote";
import { DataTable, type Column } from "../controls/DataTable";
import { ComputeButton } from "../controls/ComputeButton";
import { DerivedRuns } from "../runs/DerivedRuns";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { JobWait } from "../jobs/JobWait";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";
import { Quantity, quantity, Sentence } from "../display/Quantity";
import { ReportMenu } from "../controls/ReportMenu";
import { Section } from "../display/Section";
import { degrees, fixed } from "../../lib/text/format";

/** Decibels of a factor e. */
const DB = 20 / Math.log(10);

const withStd = (value: number | null, std: number | null, digits: number) =>
  value === null ? "" : `${fixed(value, digits)} ± ${fixed(2 * (std ?? 0), digits)}`;

const MARGINS: Column<MarginRow>[] = [
  quantity("airspeed", "Airspeed", (row) => row.airspeed_m_s, "m/s", 1),
  { key: "surface", header: "Loop", render: (row) => row.surface },
  {
    key: "gain",
    header: "Gain margin ± 2σ",
    unit: "dB",
    numeric: true,
    render: (row) =>
      withStd(
        row.gain === null ? null : DB * Math.log(row.gain),
        row.gain_std === null ? null : DB * row.gain_std,
        1,
      ),
  },
  {
    key: "phase",
    header: "Phase margin ± 2σ",
    unit: "deg",
    numeric: true,
    render: (row) =>
      withStd(
        row.phase_rad === null ? null : degrees(row.phase_rad),
        row.phase_std_rad === null ? null : degrees(row.phase_std_rad),
        1,
      ),
  },
  {
    key: "disk",
    header: "Disk margin ± 2σ",
    numeric: true,
    render: (row) => withStd(row.disk, row.disk_std, 2),
  },
];

interface Props {
  query: FlutterParams;
  controller: number | undefined;
  /** Approved global model whose runs are used because none are selected. */
  approved: ReviewedGlobalModel | undefined;
}

/** Closed-loop stability of identified models with a controller, and its margins. */
export function ClosedLoop({ query, controller, approved }: Props) {
  const { result, jobId, error, onEnd, compute } = useStoredResult(
    closedLoopResult(query, controller),
  );
  if (query.run_ids === "" || controller === undefined) {
    return (
      <div className="panel">
        <Empty title={query.run_ids === "" ? "No runs selected" : "No controllers yet"}>
          Select succeeded runs, preferably at several airspeeds, and a controller with the law u =
          K y, sign included in K.
        </Empty>
      </div>
    );
  }
  const params = { ...query, controller_id: controller };
  return (
    <Stack gap="md">
      {result.data !== undefined && (
        <Group justify="flex-end">
          <ReportMenu of="closed-loop" query={params} />
        </Group>
      )}
      <ApprovedModelNote version={approved} />
      <ComputeButton compute={compute} />
      {error !== null && <ProblemAlert error={error} />}
      {jobId !== undefined && <JobWait key={jobId} id={jobId} onEnd={onEnd} />}
      {compute === undefined && jobId === undefined && error === null && (
        <Loaded query={result} rows={6}>
          {(data) => <Stability result={data} />}
        </Loaded>
      )}
      {result.data !== undefined && (
        <>
          <div className="panel" style={{ padding: 12 }}>
            <Figure
              kind="closed-loop-margins"
              title="Margins of each loop with the others closed, ± 2σ"
              params={params}
            />
          </div>
          <div className="panel" style={{ padding: 12 }}>
            <Figure
              kind="closed-loop-roots"
              title="Open-loop and closed-loop roots"
              params={params}
            />
          </div>
          <div className="panel" style={{ padding: 12 }}>
            <Figure
              kind="control-loop"
              height={250}
              title="Control loop"
              params={{ controller_id: controller }}
            />
          </div>
          <Section
            title="Margins"
            note="Actuators and delays included; empty where the closed loop is unstable or has no crossover"
          >
            <DataTable
              label="Margins"
              testId="closed-loop-margins"
              columns={MARGINS}
              rows={result.data.margins}
              rowKey={(row) => `${row.surface} ${row.airspeed_m_s}`}
              maxHeight={420}
            />
          </Section>
        </>
      )}
    </Stack>
  );
}

function Stability({ result }: { result: ClosedLoopStability }) {
  return (
    <>
      <Alert
        variant="light"
        color={result.lost_m_s === null ? "green" : "yellow"}
        role="status"
        title={<Sentence text={result.sentence} />}
        styles={{ title: { color: "var(--mantine-color-text)" } }}
        data-testid="closed-loop-result"
      >
        {result.controller}, fuel {fixed(100 * result.fuel_fraction, 0)} %, fastest point flown{" "}
        <Quantity value={result.tested_m_s} unit="m/s" decimals={1} named />. The interval and the
        margin errors include the covariance of the runs and the spread between model structures.
      </Alert>
      <DerivedRuns runs={result.derived_runs} />
    </>
  );
}

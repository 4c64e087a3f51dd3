import { Alert, MultiSelect, Select, Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { closedLoopResult, runsQuery } from "../api/queries";
import type { ClosedLoopStability, MarginRow } from "../api/types";
import { useStoredResult } from "../api/useStoredResult";
import { NumberField } from "../components/controls/NumberField";
import { OutOfBandSwitch } from "../components/new-run/OutOfBandSwitch";
import { ApprovedModelNote } from "../components/new-run/ApprovedModelNote";
import { useDefaultRuns } from "../components/new-run/useDefaultRuns";
import { VariationSelect } from "../components/predictions/VariationSelect";
import { NewController } from "../components/predictions/NewController";
import { DataTable, type Column } from "../components/controls/DataTable";
import { ComputeButton } from "../components/controls/ComputeButton";
import { DerivedRuns } from "../components/runs/DerivedRuns";
import { Empty } from "../components/display/Empty";
import { Figure } from "../components/figures/Figure";
import { JobWait } from "../components/jobs/JobWait";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { Quantity, quantity, Sentence } from "../components/display/Quantity";
import { ReportMenu } from "../components/controls/ReportMenu";
import { Section } from "../components/display/Section";
import { degrees, fixed } from "../lib/format";
import { integers } from "../lib/urlState";
import type { ClosedLoopView } from "../views";
import { useControllersOf } from "../components/predictions/useControllersOf";

const route = getRouteApi("/closed-loop");

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

/** Closed-loop stability of identified models with a controller, and its margins. */
export function ClosedLoopPage() {
  const search = route.useSearch();
  const { view, approved } = useDefaultRuns(search);
  const navigate = route.useNavigate();
  const runs = useQuery(runsQuery({ state: "succeeded" }));
  const known = useControllersOf(view.runs?.[0]);
  const controller = view.controller ?? known[0]?.id;
  const query = {
    run_ids: (view.runs ?? []).join(","),
    fuel: view.fuel === undefined ? undefined : view.fuel / 100,
    altitude_m: view.altitude,
    unmodelled_modes: view.unmodelled_modes,
    variation: view.variation,
  };
  const { result, jobId, error, onEnd, compute } = useStoredResult(
    closedLoopResult(query, controller),
  );
  const change = (part: Partial<ClosedLoopView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });
  const params = { ...query, controller_id: controller };
  return (
    <>
      <PageHead
        title="Closed loop"
        actions={result.data !== undefined && <ReportMenu of="closed-loop" query={params} />}
        trail={[
          <Link
            to="/flutter"
            search={{
              runs: view.runs,
              fuel: view.fuel,
              altitude: view.altitude,
              unmodelled_modes: view.unmodelled_modes,
              variation: view.variation,
            }}
            className="link"
            key="flutter"
          >
            Flutter
          </Link>,
        ]}
      />
      <div className="split">
        <Stack gap="md">
          <MultiSelect
            label="Runs"
            description="Fused as for flutter prediction"
            searchable
            clearable
            hidePickedOptions
            maxDropdownHeight={320}
            data-testid="closed-loop-runs"
            data={(runs.data ?? []).map((run) => ({
              value: String(run.id),
              label: `${run.method} ${String(run.id)}: ${run.modes.join(" ")}, ${run.maneuver_label}`,
            }))}
            value={(view.runs ?? []).map(String)}
            onChange={(ids) => {
              change({ runs: integers(ids) });
            }}
          />
          <Select
            label="Controller"
            allowDeselect={false}
            placeholder="No controllers yet"
            data={known.map((one) => ({ value: String(one.id), label: one.name }))}
            value={controller === undefined ? null : String(controller)}
            onChange={(id) => {
              change({ controller: id === null ? undefined : Number(id) });
            }}
          />
          <NumberField
            label="Fuel [%]"
            placeholder="fastest point"
            min={0}
            max={100}
            value={view.fuel}
            onChange={(value) => {
              change({ fuel: value });
            }}
          />
          <NumberField
            label="Altitude"
            unit="m"
            placeholder="density of the fastest point"
            min={-1000}
            max={11000}
            value={view.altitude}
            onChange={(value) => {
              change({ altitude: value });
            }}
          />
          <OutOfBandSwitch
            value={view.unmodelled_modes}
            onChange={(unmodelled_modes) => {
              change({ unmodelled_modes });
            }}
          />
          <VariationSelect
            value={view.variation}
            onChange={(variation) => {
              change({ variation, runs: view.runs });
            }}
          />
          <NewController
            onSaved={(id) => {
              change({ controller: id });
            }}
          />
        </Stack>
        {view.runs === undefined || controller === undefined ? (
          <div className="panel">
            <Empty title={view.runs === undefined ? "No runs selected" : "No controllers yet"}>
              Select succeeded runs, preferably at several airspeeds, and a controller with the law
              u = K y, sign included in K.
            </Empty>
          </div>
        ) : (
          <Stack gap="md">
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
        )}
      </div>
    </>
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

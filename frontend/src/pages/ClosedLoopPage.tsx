import { Alert, MultiSelect, NumberInput, Select, Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useState } from "react";
import { closedLoopQuery, closedLoopTaskQuery, controllersQuery, runsQuery } from "../api/queries";
import type { ClosedLoopAnswer, MarginRow } from "../api/types";
import { CarrySwitch } from "../components/CarrySwitch";
import { NewController } from "../components/NewController";
import { DataTable, type Column } from "../components/DataTable";
import { Empty } from "../components/Empty";
import { Figure } from "../components/Figure";
import { Loaded } from "../components/Loaded";
import { PageHead } from "../components/PageHead";
import { ProblemAlert } from "../components/ProblemAlert";
import { Section } from "../components/Section";
import { TaskProgress } from "../components/TaskProgress";
import { degrees, fixed } from "../lib/format";
import { integers } from "../lib/urlState";
import type { ClosedLoopView } from "../views";

const route = getRouteApi("/closed-loop");

/** More runs than these take seconds: their answer is found as a task. */
const FEW = 6;

/** Decibels of a factor e. */
const DB = 20 / Math.log(10);

const withStd = (value: number | null, std: number | null, digits: number) =>
  value === null ? "" : `${fixed(value, digits)} ± ${fixed(2 * (std ?? 0), digits)}`;

const MARGINS: Column<MarginRow>[] = [
  {
    key: "airspeed",
    header: "Airspeed",
    unit: "m/s",
    numeric: true,
    render: (row) => fixed(row.airspeed_m_s, 1),
  },
  { key: "surface", header: "Loop of", render: (row) => row.surface },
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

/** A controller around what runs identified: where it loses the aircraft, and its margins. */
export function ClosedLoopPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const runs = useQuery(runsQuery({ state: "succeeded" }));
  const controllers = useQuery(controllersQuery);
  const known = controllers.data ?? [];
  const controller = view.controller ?? known[0]?.id;
  const question = {
    run_ids: (view.runs ?? []).join(","),
    fuel: view.fuel === undefined ? undefined : view.fuel / 100,
    altitude_m: view.altitude,
    others: view.others,
  };
  const many = (view.runs ?? []).length > FEW;
  const task = useQuery(closedLoopTaskQuery(question, controller, many));
  const [found, setFound] = useState("");
  const ready = !many || found === task.data?.id;
  const answer = useQuery(closedLoopQuery(question, controller, ready));
  const change = (part: Partial<ClosedLoopView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });
  const params = { ...question, controller_id: controller };
  return (
    <>
      <PageHead
        title="Closed loop"
        trail={[
          <Link
            to="/flutter"
            search={{
              runs: view.runs,
              fuel: view.fuel,
              altitude: view.altitude,
              others: view.others,
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
            description="Fused as for flutter"
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
            placeholder="None known yet"
            data={known.map((one) => ({ value: String(one.id), label: one.name }))}
            value={controller === undefined ? null : String(controller)}
            onChange={(id) => {
              change({ controller: id === null ? undefined : Number(id) });
            }}
          />
          <NumberInput
            label="Fuel [%]"
            placeholder="the fastest point's"
            min={0}
            max={100}
            value={view.fuel ?? ""}
            onChange={(value) => {
              change({ fuel: typeof value === "number" ? value : undefined });
            }}
          />
          <NumberInput
            label="Altitude [m]"
            placeholder="the fastest point's air"
            min={-1000}
            max={11000}
            value={view.altitude ?? ""}
            onChange={(value) => {
              change({ altitude: typeof value === "number" ? value : undefined });
            }}
          />
          <CarrySwitch
            others={view.others}
            onChange={(others) => {
              change({ others });
            }}
          />
          <NewController
            onKept={(id) => {
              change({ controller: id });
            }}
          />
        </Stack>
        {view.runs === undefined || controller === undefined ? (
          <div className="panel">
            <Empty title={view.runs === undefined ? "No runs chosen" : "No controller known"}>
              Choose runs that succeeded, best over several airspeeds, and a controller; its law is
              taken as u = K y with the sign in K.
            </Empty>
          </div>
        ) : (
          <Stack gap="md">
            {task.isError && many && <ProblemAlert error={task.error} />}
            {!ready && task.data !== undefined && (
              <TaskProgress
                key={task.data.id}
                task={task.data}
                onDone={() => {
                  setFound(task.data.id);
                }}
              />
            )}
            {ready && (
              <>
                <Loaded query={answer} rows={6}>
                  {(data) => <Answer answer={data} />}
                </Loaded>
                <div className="panel" style={{ padding: 12 }}>
                  <Figure
                    kind="closed-loop-margins"
                    title="Margins of every loop, the others closed, ± 2σ"
                    params={params}
                  />
                </div>
                <div className="panel" style={{ padding: 12 }}>
                  <Figure
                    kind="closed-loop-roots"
                    title="Roots without and with the controller"
                    params={params}
                  />
                </div>
                <Loaded query={answer} rows={6}>
                  {(data) => (
                    <Section
                      title="Margins"
                      note="Actuators and delays included; empty where the closed loop is unstable or nothing is crossed"
                    >
                      <DataTable
                        label="Margins"
                        testId="closed-loop-margins"
                        columns={MARGINS}
                        rows={data.margins}
                        rowKey={(row) => `${row.surface} ${row.airspeed_m_s}`}
                        maxHeight={420}
                      />
                    </Section>
                  )}
                </Loaded>
              </>
            )}
          </Stack>
        )}
      </div>
    </>
  );
}

function Answer({ answer }: { answer: ClosedLoopAnswer }) {
  return (
    <Alert
      variant="light"
      color={answer.lost_m_s === null ? "green" : "yellow"}
      role="status"
      title={answer.sentence}
      styles={{ title: { color: "var(--mantine-color-text)" } }}
      data-testid="closed-loop-answer"
    >
      {answer.controller}, fuel {fixed(100 * answer.fuel_fraction, 0)} %, fastest point flown{" "}
      {fixed(answer.tested_m_s, 1)} m/s. The interval and the errors of the margins hold what the
      runs&apos; covariance makes of them and the spread between model structures.
    </Alert>
  );
}

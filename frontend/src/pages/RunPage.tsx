import { Alert } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { maneuverQuery, runQuery } from "../api/queries";
import { isOver, methodName, type Maneuver, type Run } from "../api/types";
import { AerodynamicsVerdict } from "../components/runs/AerodynamicsVerdict";
import { Figure } from "../components/figures/Figure";
import { RunDerivation } from "../components/runs/DerivedRuns";
import { FitTab } from "../components/runs/FitTab";
import { JobProgress } from "../components/jobs/JobProgress";
import { Loaded } from "../components/display/Loaded";
import { AdequacyLine, AdequacyTests } from "../components/runs/ModelAdequacy";
import { NamedCorrections } from "../components/runs/NamedCorrections";
import { OtherAxis } from "../components/maneuvers/OtherAxis";
import { NotesButton, type NoteTopic } from "../components/display/Notes";
import { PageHead } from "../components/frame/PageHead";
import { SectionTabs, type SectionContents } from "../components/frame/SectionTabs";
import { NuisanceParameters } from "../components/runs/NuisanceParameters";
import { ParameterTable } from "../components/runs/ParameterTable";
import { Posterior } from "../components/runs/Posterior";
import { PoleTable } from "../components/runs/PoleTable";
import { Provenance } from "../components/runs/Provenance";
import { StateBadge } from "../components/runs/RunBadge";
import { RunActions } from "../components/runs/RunActions";
import { RunIntegrity } from "../components/runs/RunIntegrity";
import { RunOutcome } from "../components/runs/RunOutcome";
import { SensorsTab } from "../components/runs/SensorsTab";
import { TimeTab } from "../components/runs/TimeTab";
import { WriteBack } from "../components/runs/WriteBack";
import { overFrequency } from "../lib/figures/band";
import { parseDerivative } from "../lib/derivatives";
import { RUN_TABS, type RunView } from "../views";

const route = getRouteApi("/runs/$id");

const TAB_NAMES = { result: "Result", fit: "Fit", checks: "Checks", record: "Record" };

type RunSection = (typeof RUN_TABS)[keyof typeof RUN_TABS][number];

/** One estimation run, from waiting to result. */
export function RunPage() {
  const { id } = route.useParams();
  const run = useQuery(runQuery(id));
  return (
    <Loaded query={run} page={`Run ${id}`}>
      {(data) => <OneRun run={data} />}
    </Loaded>
  );
}

function OneRun({ run }: { run: Run }) {
  const maneuver = useQuery(maneuverQuery(run.maneuver_id));
  const label = maneuver.data?.label ?? `Maneuver ${run.maneuver_id}`;
  return (
    <>
      <PageHead
        title={`${methodName(run.method)}, run ${run.id}`}
        trail={[
          <Link to="/campaign" className="link" key="campaign">
            Campaign
          </Link>,
          <Link
            to="/maneuvers/$id"
            params={{ id: run.maneuver_id }}
            search={{ tab: "runs" }}
            className="link"
            key="maneuver"
          >
            {label}
          </Link>,
        ]}
        aside={<StateBadge state={run.state} />}
        actions={
          isOver(run.state) && (
            <>
              {maneuver.data !== undefined && (
                <NotesButton filter={{ run_id: run.id }} topics={noteTopics(run, maneuver.data)} />
              )}
              <RunActions run={run} />
            </>
          )
        }
      />
      {!isOver(run.state) && (
        <div className="panel" style={{ padding: 16 }}>
          <JobProgress id={run.id} />
        </div>
      )}
      {run.state === "cancelled" && (
        <Alert color="yellow" variant="light">
          This run was cancelled before it ended; it has no result.
        </Alert>
      )}
      {run.state === "failed" && (
        <Alert color="red" variant="light" title="The estimation failed" mb="md">
          {run.error?.message ?? "The worker gave no reason."}
        </Alert>
      )}
      {maneuver.data?.axis === "combined" && <OtherAxis run={run} />}
      <RunDerivation run={run} />
      <RunIntegrity run={run} />
      {run.fit !== null && <RunOutcome run={run} fit={run.fit} />}
      {run.adequacy !== null && <AdequacyLine adequacy={run.adequacy} title="Model adequacy" />}
      <NamedCorrections run={run} />
      {run.symmetry !== null && <AdequacyLine adequacy={run.symmetry} title="Symmetry" />}
      {isOver(run.state) && <Results run={run} />}
    </>
  );
}

/** The run, its maneuver, its modes and its derivatives. */
function noteTopics(run: Run, maneuver: Maneuver): NoteTopic[] {
  const { aircraft_id } = maneuver;
  return [
    { subject: "run", key: String(run.id), label: `Run ${run.id}` },
    { subject: "maneuver", key: String(run.maneuver_id), label: `Maneuver ${maneuver.label}` },
    ...run.structure.modes.map((mode) => ({
      subject: "mode" as const,
      key: String(mode),
      aircraft_id,
      label: `Mode ${mode}`,
    })),
    ...run.parameters
      .filter(({ name }) => parseDerivative(name) !== null)
      .map(({ name }) => ({ subject: "derivative" as const, key: name, aircraft_id, label: name })),
  ];
}

function Results({ run }: { run: Run }) {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const change = (part: Partial<RunView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });
  if (run.fit === null) {
    return (
      <div style={{ marginTop: 16 }}>
        <Provenance run={run} />
      </div>
    );
  }
  const block = view.block ?? run.blocks[0]?.name;
  const tabProps = { run, view, onChange: change };
  const panel = (kind: string, title: string, height?: number) => (
    <div className="panel" style={{ padding: 12 }}>
      <Figure
        kind={kind}
        title={title}
        params={{ run_id: run.id, ...(kind === "residual" ? { block } : {}) }}
        height={height}
        {...(kind === "residual" ? overFrequency(view, change) : {})}
      />
    </div>
  );
  const contents: SectionContents<RunSection> = {
    parameters: [
      "Parameters",
      <>
        <div className="panel">
          <ParameterTable
            parameters={run.parameters}
            noiseShare={run.retained?.noise_share}
            sort={view.sort}
            onSort={(sort) => {
              change({ sort });
            }}
          />
        </div>
        {run.retained !== null && (
          <NuisanceParameters retained={run.retained} reasons={run.proposal?.reasons ?? []} />
        )}
      </>,
    ],
    poles: [
      "Poles",
      <div className="halves">
        <div className="panel">
          <PoleTable poles={run.poles} />
        </div>
        {panel("poles", "Poles of the identified model", 440)}
      </div>,
    ],
    correlation: [
      "Correlation of the estimates",
      panel("parameter-correlation", "Correlation of the estimates", 760),
    ],
    fit: ["Over frequency", <FitTab {...tabProps} />],
    residuals: [
      "Residuals",
      panel("residual", `Residuals of ${block ?? "the fit"} over frequency`),
    ],
    time: ["Over time", <TimeTab {...tabProps} />],
    tests: ["Model adequacy", <AdequacyTests run={run} />],
    sensors: ["Sensors", <SensorsTab {...tabProps} />],
    aerodynamics: ["Aerodynamics", <AerodynamicsVerdict runId={run.id} />],
    posterior: ["Posterior", <Posterior run={run} />],
    "write-back": ["Write back", <WriteBack run={run} />],
    provenance: ["Provenance", <Provenance run={run} />],
    iterations: ["Iterations", panel("iterations", "Cost by iteration")],
  };
  return (
    <SectionTabs
      label="Run"
      sections={RUN_TABS}
      titles={TAB_NAMES}
      contents={contents}
      tab={view.tab ?? "result"}
      onTab={(tab) => {
        change({ tab });
      }}
    />
  );
}

import { Button, Group, SegmentedControl, Select, Stack, Tabs } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link, useNavigate } from "@tanstack/react-router";
import type { ReactNode } from "react";
import { useRedesign } from "../api/commands";
import { designQuery, runsQuery } from "../api/queries";
import type { Design } from "../api/types";
import { AmplitudesPart } from "../components/designs/AmplitudesPart";
import { ClassicInputsPart } from "../components/designs/ClassicInputsPart";
import { Facts } from "../components/display/ConditionFacts";
import { Checks } from "../components/designs/DesignChecks";
import { Empty } from "../components/display/Empty";
import { PredictedAccuracyPart } from "../components/designs/PredictedAccuracyPart";
import { Figure } from "../components/figures/Figure";
import { Loaded } from "../components/display/Loaded";
import { OptimalDesignPart } from "../components/designs/OptimalDesignPart";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { PreflightPart } from "../components/designs/PreflightPart";
import { Section } from "../components/display/Section";
import { TargetModesPart } from "../components/designs/TargetModesPart";
import { JobWait } from "../components/jobs/JobWait";
import { overFrequency } from "../lib/figures/band";
import { bandOf } from "../lib/drafts/designDraft";
import { fixed } from "../lib/text/format";
import { DESIGN_TABS, type DesignView } from "../views";

const route = getRouteApi("/excitation/$id");

const LEVELS = ["Low", "Medium", "High"];
const FORMS = ["csv", "mat", "h", "json"] as const;
const TAB_NAMES: Record<(typeof DESIGN_TABS)[number], string> = {
  excitation: "Excitation",
  accuracy: "Predicted accuracy",
  amplitudes: "Amplitude optimisation",
  optimal: "Optimal design",
  classic: "Classic inputs",
  "preflight-simulation": "Pre-flight simulation",
};

type Change = (part: Partial<DesignView>) => void;

/** One excitation design: commands, surface motion, predicted accuracy, simulation. */
export function DesignPage() {
  const { id } = route.useParams();
  const design = useQuery(designQuery(id));
  return (
    <Loaded query={design} page={`Design ${id}`}>
      {(data) => <OneDesign design={data} />}
    </Loaded>
  );
}

function OneDesign({ design }: { design: Design }) {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const anywhere = useNavigate();
  const redesign = useRedesign(design.id);
  const level = view.level ?? 1;
  const change: Change = (part) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }), replace: true });
  const params = { design_id: design.id, level };
  return (
    <>
      <PageHead
        title={design.name}
        trail={[
          <Link to="/campaign" className="link" key="campaign">
            Campaign
          </Link>,
          <Link to="/excitation" className="link" key="excitation">
            Excitation
          </Link>,
        ]}
        actions={
          <Group gap="sm">
            {FORMS.map((form) => (
              <a
                key={form}
                className="link"
                href={`/api/v1/designs/${design.id}/export?form=${form}&level=${level}`}
              >
                {form}
              </a>
            ))}
            <a
              className="link"
              target="_blank"
              rel="noreferrer"
              href={`/api/v1/reports/run-card/${design.id}?level=${level}`}
            >
              Run card
            </a>
            <Button
              variant="default"
              size="xs"
              loading={redesign.isPending}
              onClick={() => {
                redesign.mutate(`${design.name}, new phases`);
              }}
            >
              Re-optimise phases
            </Button>
          </Group>
        }
      />
      {redesign.isError && <ProblemAlert error={redesign.error} />}
      {redesign.data !== undefined && (
        <JobWait
          key={redesign.data.id}
          id={redesign.data.id}
          onEnd={({ result }) => {
            const id = result?.design_id;
            if (typeof id === "number") void anywhere({ to: "/excitation/$id", params: { id } });
          }}
        />
      )}
      <Group align="end" gap="xl">
        <Facts
          facts={[
            ["Duration", fixed(design.specification.duration_s, 1), "s"],
            ["Rate", fixed(design.specification.rate_hz, 0), "Hz"],
            ["Band", bandOf(design), "Hz"],
            ["Inputs", design.specification.inputs.length],
            [
              "Harmonics",
              design.specification.inputs.reduce((sum, own) => sum + own.harmonics.length, 0),
            ],
            ["Highest RPF", fixed(Math.max(...Object.values(design.peak_factors)), 3)],
          ]}
        />
        <SegmentedControl
          aria-label="Amplitude"
          data={LEVELS.map((label, index) => ({ value: String(index), label }))}
          value={String(level)}
          onChange={(value) => {
            change({ level: Number(value) });
          }}
        />
      </Group>
      <Tabs
        mt="md"
        keepMounted={false}
        value={view.tab ?? "excitation"}
        onChange={(next) => {
          change({ tab: DESIGN_TABS.find((one) => one === next) });
        }}
      >
        <Tabs.List aria-label="Design">
          {DESIGN_TABS.map((name) => (
            <Tabs.Tab key={name} value={name} data-testid={`tab-${name}`}>
              {TAB_NAMES[name]}
            </Tabs.Tab>
          ))}
        </Tabs.List>
        <Tabs.Panel value="excitation" pt="md">
          <Stack gap="md">
            <TargetModesPart
              design={design}
              aircraft={view.aircraft}
              airspeed={view.airspeed}
              onChange={change}
            />
            <Checks design={design} level={level} view={view} onChange={change} />
            <div className="panel" style={{ padding: 12 }}>
              <Figure kind="design-history" title="Commands over one period" params={params} />
            </div>
            <div className="panel" style={{ padding: 12 }}>
              <Figure
                {...overFrequency(view, change)}
                kind="design-spectrum"
                title="Harmonics by input"
                params={params}
              />
            </div>
          </Stack>
        </Tabs.Panel>
        <Tabs.Panel value="accuracy" pt="md">
          <ForRun view={view} onChange={change}>
            {(run) => (
              <PredictedAccuracyPart
                design={design}
                level={level}
                run={run}
                shared={overFrequency(view, change)}
              />
            )}
          </ForRun>
        </Tabs.Panel>
        <Tabs.Panel value="amplitudes" pt="md">
          <ForRun view={view} onChange={change}>
            {(run) => (
              <Section
                title="Amplitude optimisation"
                note="Same harmonics and phases; surface and load factor limits include feedback"
              >
                <AmplitudesPart
                  design={design}
                  level={level}
                  run={run}
                  allowed={view.allowed}
                  fastest={view.fastest}
                  load={view.load}
                  onChange={change}
                />
              </Section>
            )}
          </ForRun>
        </Tabs.Panel>
        <Tabs.Panel value="optimal" pt="md">
          <ForRun view={view} onChange={change}>
            {(run) => (
              <Section
                title="Optimal design"
                note="Same harmonics; powers and phases are optimised for one objective, within limits that include feedback"
              >
                <OptimalDesignPart
                  design={design}
                  level={level}
                  run={run}
                  view={view}
                  onChange={change}
                />
              </Section>
            )}
          </ForRun>
        </Tabs.Panel>
        <Tabs.Panel value="classic" pt="md">
          <ForRun view={view} onChange={change}>
            {(run) => (
              <Section
                title="Comparison with classic inputs"
                note="Surfaces in sequence, same duration and band, within the deflection and load factor of the design; pulse length of most information"
              >
                <ClassicInputsPart design={design} level={level} run={run} />
              </Section>
            )}
          </ForRun>
        </Tabs.Panel>
        <Tabs.Panel value="preflight-simulation" pt="md">
          <ForRun view={view} onChange={change}>
            {(run) => <PreflightPart design={design} level={level} run={run} />}
          </ForRun>
        </Tabs.Panel>
      </Tabs>
    </>
  );
}

interface ForRunProps {
  view: DesignView;
  onChange: Change;
  children: (run: number) => ReactNode;
}

/** Run selection, and the content that requires a run. */
function ForRun({ view, onChange, children }: ForRunProps) {
  const runs = useQuery(runsQuery({ method: "OE", state: "succeeded" }));
  return (
    <Stack gap="md">
      <Select
        label="Output-error run (model, condition and noise)"
        clearable
        searchable
        w={420}
        data={(runs.data ?? []).map((run) => ({
          value: String(run.id),
          label: `OE run ${run.id}, modes ${run.modes.join(" ")}, ${run.maneuver_label}`,
        }))}
        value={view.run === undefined ? null : String(view.run)}
        onChange={(id) => {
          onChange({ run: id === null ? undefined : Number(id) });
        }}
      />
      {view.run === undefined ? (
        <Empty title="No run selected">
          Select an output-error run. Its model, noise and surface motion are used to evaluate this
          design.
        </Empty>
      ) : (
        children(view.run)
      )}
    </Stack>
  );
}

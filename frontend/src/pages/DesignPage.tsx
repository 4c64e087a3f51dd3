import { Group, NumberInput, SegmentedControl, Select, Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { designChecksQuery, designQuery, expectedErrorsQuery, runsQuery } from "../api/queries";
import type { Design, DesignChecks, ExpectedError } from "../api/types";
import { AllocationPart } from "../components/AllocationPart";
import { Facts } from "../components/ConditionFacts";
import { DataTable, type Column } from "../components/DataTable";
import { DerivativeName } from "../components/DerivativeName";
import { Empty } from "../components/Empty";
import { Figure } from "../components/Figure";
import { Loaded } from "../components/Loaded";
import { PageHead } from "../components/PageHead";
import { Section } from "../components/Section";
import { degrees, fixed, relativeError, withError } from "../lib/format";
import type { DesignView } from "../views";

const route = getRouteApi("/excitation/$id");

const RADIAN = 180 / Math.PI;
const LEVELS = ["Low", "Medium", "High"];
const FORMS = ["csv", "mat", "h", "json"] as const;
const ACTUATOR = 60; // rad/s: a typical surface actuator until the user says another

type Change = (part: Partial<DesignView>) => void;

/** One designed excitation: what it commands, what the surfaces make of it, what it would tell. */
export function DesignPage() {
  const { id } = route.useParams();
  const design = useQuery(designQuery(id));
  return <Loaded query={design}>{(data) => <OneDesign design={data} />}</Loaded>;
}

function OneDesign({ design }: { design: Design }) {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const level = view.level ?? 1;
  const change: Change = (part) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }), replace: true });
  const params = { design_id: design.id, level };
  return (
    <>
      <PageHead
        title={design.name}
        trail={[
          <Link to="/" className="link" key="campaign">
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
          </Group>
        }
      />
      <Group align="end" gap="xl">
        <Facts
          facts={[
            ["Duration", fixed(design.wish.duration_s, 1), "s"],
            ["Rate", fixed(design.wish.rate_hz, 0), "Hz"],
            ["Inputs", design.wish.inputs.length],
            ["Harmonics", design.wish.inputs.reduce((sum, own) => sum + own.harmonics.length, 0)],
            ["Highest RPF", fixed(Math.max(...Object.values(design.peak_factors)), 3)],
          ]}
        />
        <SegmentedControl
          aria-label="Amplitude"
          data={LEVELS.map((label, place) => ({ value: String(place), label }))}
          value={String(level)}
          onChange={(value) => {
            change({ level: Number(value) });
          }}
        />
      </Group>
      <Stack gap="md" mt="md">
        <Checks design={design} level={level} view={view} onChange={change} />
        <div className="panel" style={{ padding: 12 }}>
          <Figure kind="design-history" title="One period as commanded" params={params} />
        </div>
        <div className="panel" style={{ padding: 12 }}>
          <Figure
            kind="design-spectrum"
            title="Lines by the input that owns them"
            params={params}
          />
        </div>
        <Expected design={design} level={level} view={view} onChange={change} />
        {view.run !== undefined && (
          <Section
            title="Amplitudes that would tell more"
            note="Same lines and phases; surfaces and load factor with feedback, within limits"
          >
            <AllocationPart
              design={design}
              level={level}
              run={view.run}
              allowed={view.allowed}
              load={view.load}
              onChange={change}
            />
          </Section>
        )}
      </Stack>
    </>
  );
}

interface PartProps {
  design: Design;
  level: number;
  view: DesignView;
  onChange: Change;
}

const CHECK_COLUMNS: Column<DesignChecks["inputs"][number]>[] = [
  { key: "name", header: "Input", render: (row) => row.name },
  { key: "rpf", header: "RPF", numeric: true, render: (row) => fixed(row.peak_factor, 3) },
  {
    key: "command",
    header: "Command",
    unit: "deg",
    numeric: true,
    render: (row) => fixed(degrees(row.command_peak), 2),
  },
  {
    key: "deflection",
    header: "Deflection",
    unit: "deg",
    numeric: true,
    render: (row) => fixed(degrees(row.deflection_peak), 2),
  },
  {
    key: "rate",
    header: "Rate",
    unit: "deg/s",
    numeric: true,
    render: (row) => fixed(degrees(row.rate_peak), 1),
  },
  {
    key: "acceleration",
    header: "Acceleration",
    unit: "deg/s²",
    numeric: true,
    render: (row) => fixed(degrees(row.acceleration_peak), 0),
  },
  {
    key: "limits",
    header: "Limits",
    render: (row) => (row.within_limits ? "within" : "exceeded"),
  },
];

function Checks({ design, level, view, onChange }: PartProps) {
  const checks = useQuery(
    designChecksQuery(design.id, level, {
      natural_frequency: view.actuator ?? ACTUATOR,
      position: view.position === undefined ? undefined : view.position / RADIAN,
      rate: view.rate === undefined ? undefined : view.rate / RADIAN,
    }),
  );
  return (
    <Section title="Behind the actuator" note="Largest of one period, damping ratio 0.7">
      <Group mb="sm">
        <Limit
          label="Natural frequency [rad/s]"
          value={view.actuator}
          placeholder={String(ACTUATOR)}
          onChange={(actuator) => {
            onChange({ actuator });
          }}
        />
        <Limit
          label="Deflection limit [deg]"
          value={view.position}
          onChange={(position) => {
            onChange({ position });
          }}
        />
        <Limit
          label="Rate limit [deg/s]"
          value={view.rate}
          onChange={(rate) => {
            onChange({ rate });
          }}
        />
      </Group>
      <Loaded query={checks} rows={design.wish.inputs.length}>
        {(found) => (
          <>
            <DataTable
              label="Inputs"
              testId="design-checks"
              columns={CHECK_COLUMNS}
              rows={found.inputs}
              rowKey={(row) => row.name}
              isSelected={(row) => !row.within_limits}
            />
            <p className="quiet">
              Largest correlation between two inputs over a period:{" "}
              {found.correlation.toExponential(1)}
            </p>
          </>
        )}
      </Loaded>
    </Section>
  );
}

interface LimitProps {
  label: string;
  value: number | undefined;
  placeholder?: string;
  onChange: (value: number | undefined) => void;
}

function Limit({ label, value, placeholder = "none", onChange }: LimitProps) {
  return (
    <NumberInput
      label={label}
      placeholder={placeholder}
      min={0.01}
      w={190}
      value={value ?? ""}
      onChange={(next) => {
        onChange(typeof next === "number" && next > 0 ? next : undefined);
      }}
    />
  );
}

const EXPECTED_COLUMNS: Column<ExpectedError>[] = [
  { key: "name", header: "Derivative", render: (row) => <DerivativeName name={row.name} /> },
  {
    key: "value",
    header: "Value of the run",
    numeric: true,
    render: (row) => withError(row.value, row.std_error).value,
  },
  {
    key: "error",
    header: "Expected σ",
    numeric: true,
    render: (row) => withError(row.value, row.std_error).error,
  },
  {
    key: "relative",
    header: "of the value",
    unit: "%",
    numeric: true,
    render: (row) => fixed(relativeError(row.value, row.std_error), 1),
  },
];

function Expected({ design, level, view, onChange }: PartProps) {
  const runs = useQuery(runsQuery({ method: "OE", state: "succeeded" }));
  const expected = useQuery(expectedErrorsQuery(design.id, level, view.run));
  return (
    <Section
      title="What it would tell"
      note="For the model, condition and noise of a run; what its model misses grows with the amplitude"
    >
      <Select
        label="Output-error run"
        clearable
        searchable
        mb="sm"
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
        <Empty title="No run chosen">
          Choose an output-error run to see the standard errors that this design would give.
        </Empty>
      ) : (
        <Loaded query={expected} rows={10}>
          {(told) => (
            <>
              <p className="quiet">
                Surfaces follow {told.surfaces}.
                {told.lines_outside > 0 &&
                  ` ${told.lines_outside} lines lie outside those of the run: what is known at its ends is taken to hold there.`}
              </p>
              <DataTable
                label="Expected standard errors"
                testId="expected-errors"
                columns={EXPECTED_COLUMNS}
                rows={told.items}
                rowKey={(row) => row.name}
              />
            </>
          )}
        </Loaded>
      )}
    </Section>
  );
}

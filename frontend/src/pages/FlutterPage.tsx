import { Alert, Group, SegmentedControl, Select, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import {
  flutterResult,
  predictedFlutterResult,
  predictionsQuery,
  type FlutterParams,
} from "../api/queries";
import type { QueryValue } from "../api/client";
import type { Flutter, Prediction } from "../api/types";
import { useConversion } from "../api/units";
import { useStoredResult } from "../api/useStoredResult";
import { DataTable, numeric, type Column } from "../components/controls/DataTable";
import { DerivedRuns } from "../components/runs/DerivedRuns";
import { RunChoice } from "../components/runs/RunChoice";
import { NumberField } from "../components/controls/NumberField";
import { OutOfBandSwitch } from "../components/new-run/OutOfBandSwitch";
import { ApprovedModelNote } from "../components/new-run/ApprovedModelNote";
import { useDefaultRuns } from "../components/new-run/useDefaultRuns";
import { VariationSelect } from "../components/predictions/VariationSelect";
import { ComputeButton } from "../components/controls/ComputeButton";
import { Empty } from "../components/display/Empty";
import { Figure } from "../components/figures/Figure";
import { JobWait } from "../components/jobs/JobWait";
import { Loaded } from "../components/display/Loaded";
import { AdequacyBadge } from "../components/runs/ModelAdequacy";
import { PageHead } from "../components/frame/PageHead";
import { SectionTabs, type SectionContents } from "../components/frame/SectionTabs";
import { ClosedLoop } from "../components/predictions/ClosedLoop";
import { NewController } from "../components/predictions/NewController";
import { useControllersOf } from "../components/predictions/useControllersOf";
import { PredictionAxisPicker } from "../components/predictions/PredictionAxisPicker";
import { StoredPredictedFlutter } from "../components/predictions/PredictedFlutter";
import { ProblemAlert } from "../components/display/ProblemAlert";
import {
  Quantity,
  quantity,
  Sentence,
  UnitName,
  WithInterval,
} from "../components/display/Quantity";
import { ReportMenu } from "../components/controls/ReportMenu";
import { Section } from "../components/display/Section";
import { converted, fixed, hertz, percent } from "../lib/text/format";
import { FLUTTER_TABS, type FlutterView } from "../views";

const route = getRouteApi("/flutter");

const ALONG = [
  { value: "airspeed", label: "Airspeed" },
  { value: "dynamic_pressure", label: "Dynamic pressure" },
  { value: "fuel", label: "Fuel" },
];

/** Flutter prediction of the identified models, and the margin of the next test point. */
export function FlutterPage() {
  const search = route.useSearch();
  const tab = search.tab ?? "flutter";
  const { view, approved } = useDefaultRuns(
    search,
    tab === "closed-loop" || search.prediction === undefined,
  );
  const navigate = route.useNavigate();
  const runs = view.runs ?? [];
  const query = {
    run_ids: runs.join(","),
    fuel: view.fuel === undefined ? undefined : view.fuel / 100,
    altitude_m: view.altitude,
    next_m_s: view.next,
    unmodelled_modes: view.unmodelled_modes,
    variation: view.variation,
  };
  const { result, jobId, error, onEnd, compute } = useStoredResult(
    flutterResult(tab === "flutter" ? query : { run_ids: "" }),
  );
  const ready = result.data !== undefined;
  const known = useControllersOf(view.runs?.[0]);
  const controller = view.controller ?? known[0]?.id;
  const alone = runs.length === 0 && view.prediction !== undefined;
  // Beside flight: in the same axis, at the same loading, air density and airspeeds.
  const beside = result.data && {
    axis: result.data.axis ?? undefined,
    fuel: result.data.fuel_fraction,
    density_kg_m3: result.data.density_kg_m3,
    from_m_s: result.data.searched_from_m_s,
    to_m_s: result.data.searched_to_m_s,
  };
  const others = alone ? { axis: view.axis, fuel: query.fuel } : beside;
  const ofPrediction =
    view.prediction === undefined || others === undefined
      ? undefined
      : { prediction_id: view.prediction, ...others };
  const predicted = useStoredResult(predictedFlutterResult(ofPrediction));
  const change = (part: Partial<FlutterView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });
  const flutter = alone ? (
    <Stack gap="md">
      <StoredPredictedFlutter stored={predicted} />
      {predicted.result.data !== undefined && ofPrediction !== undefined && (
        <>
          <div className="panel" style={{ padding: 12 }}>
            <Figure
              kind="predicted-v-omega-zeta"
              title="Frequency and damping of the prediction"
              params={ofPrediction}
            />
          </div>
          <div className="panel" style={{ padding: 12 }}>
            <Figure
              kind="predicted-root-locus"
              title="Root locus of the prediction"
              params={ofPrediction}
            />
          </div>
        </>
      )}
    </Stack>
  ) : runs.length === 0 ? (
    <div className="panel">
      <Empty title="No runs selected">
        Select succeeded runs, preferably at several airspeeds. Runs of one model structure are
        fused; other structures show the sensitivity to the structure. A prediction alone gives
        flutter without flight.
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
          {(data) => <Prediction result={data} />}
        </Loaded>
      )}
      {ready && view.prediction !== undefined && <StoredPredictedFlutter stored={predicted} />}
      {ready && (
        <Figures
          query={query}
          predictionId={predicted.result.data === undefined ? undefined : view.prediction}
          along={view.along}
          onAlong={(along) => {
            change({ along });
          }}
        />
      )}
      {ready && <Details result={result.data} shown={query} />}
    </Stack>
  );
  const contents: SectionContents<keyof typeof FLUTTER_TABS> = {
    flutter: ["Flutter", flutter],
    "closed-loop": [
      "Closed loop",
      <ClosedLoop
        query={{ ...query, next_m_s: undefined }}
        controller={controller}
        approved={approved}
      />,
    ],
  };
  return (
    <>
      <PageHead
        title="Flutter"
        trail={[
          <Link to="/campaign" className="link" key="campaign">
            Campaign
          </Link>,
        ]}
        actions={ready && <ReportMenu of="flutter" query={query} />}
      />
      <div className="split">
        <Choices
          view={view}
          tab={tab}
          controllers={known}
          controller={controller}
          result={result.data}
          onChange={change}
        />
        <SectionTabs
          label="Flutter"
          sections={FLUTTER_TABS}
          titles={{ flutter: "Flutter", "closed-loop": "Closed loop" }}
          contents={contents}
          tab={tab}
          onTab={(next) => {
            change({ tab: next });
          }}
        />
      </div>
    </>
  );
}

interface FiguresProps {
  query: FlutterParams;
  predictionId: number | undefined;
  along: FlutterView["along"];
  onAlong: (along: FlutterView["along"]) => void;
}

function Figures({ query, predictionId, along, onAlong }: FiguresProps) {
  const shown = { ...query };
  const roots = { ...query, along, prediction_id: predictionId };
  return (
    <>
      <div className="panel" style={{ padding: 12 }}>
        <Group gap="xs" mb="xs">
          <Text size="sm">Roots over</Text>
          <SegmentedControl
            size="xs"
            aria-label="Roots over"
            data-testid="flutter-along"
            data={ALONG}
            value={along ?? "airspeed"}
            onChange={(value) => {
              onAlong(value === "airspeed" ? undefined : (value as FlutterView["along"]));
            }}
          />
        </Group>
        <Figure kind="v-omega-zeta" title="Frequency and damping" params={roots} />
      </div>
      <div className="panel" style={{ padding: 12 }}>
        <Figure kind="root-locus" title="Root locus" params={roots} />
      </div>
      <div className="panel" style={{ padding: 12 }}>
        <Figure
          kind="flutter-forecast"
          title="Flutter speed against the speed flown"
          params={shown}
        />
      </div>
      <div className="panel" style={{ padding: 12 }}>
        <Figure kind="flutter-map" title="Flutter speed over fuel and altitude" params={shown} />
      </div>
    </>
  );
}

const hasBothAxes = (prediction: Prediction | undefined) =>
  ["_alpha", "_beta"].every((motion) =>
    prediction?.names.some((name) => name.startsWith("CQ") && name.endsWith(motion)),
  );

interface ChoicesProps {
  view: FlutterView;
  tab: keyof typeof FLUTTER_TABS;
  controllers: ReturnType<typeof useControllersOf>;
  controller: number | undefined;
  result: Flutter | undefined;
  onChange: (change: Partial<FlutterView>) => void;
}

function Choices({ view, tab, controllers, controller, result, onChange }: ChoicesProps) {
  const predictions = useQuery(predictionsQuery());
  const airspeed = useConversion()("m/s");
  const prediction = predictions.data?.find((one) => one.id === view.prediction);
  return (
    <Stack gap="md">
      <RunChoice
        description="Method, modes and maneuver"
        selected={view.runs ?? []}
        onChange={(runs) => {
          onChange({ runs });
        }}
      />
      {tab === "closed-loop" ? (
        <Select
          label="Controller"
          allowDeselect={false}
          placeholder="No controllers yet"
          data={controllers.map((one) => ({ value: String(one.id), label: one.name }))}
          value={controller === undefined ? null : String(controller)}
          onChange={(id) => {
            onChange({ controller: id === null ? undefined : Number(id) });
          }}
        />
      ) : (
        <>
          <Select
            label="Prediction"
            description="Its flutter, beside that of the runs or alone"
            clearable
            data-testid="flutter-prediction"
            data={(predictions.data ?? [])
              .filter((one) => one.names.some((name) => name.startsWith("CQ")))
              .map((one) => ({ value: String(one.id), label: one.source }))}
            value={view.prediction === undefined ? null : String(view.prediction)}
            onChange={(id) => {
              onChange({ prediction: id === null ? undefined : Number(id), axis: undefined });
            }}
          />
          {(view.runs ?? []).length === 0 && hasBothAxes(prediction) && (
            <PredictionAxisPicker
              value={view.axis ?? "longitudinal"}
              onChange={(axis) => {
                onChange({ axis });
              }}
            />
          )}
          <NumberField
            label="Next test point"
            unit="m/s"
            description="Default: 3 % above the highest airspeed flown"
            placeholder={result && converted(result.next_m_s, airspeed.factor, 1)}
            min={1}
            value={view.next}
            onChange={(value) => {
              onChange({ next: value });
            }}
          />
        </>
      )}
      <OutOfBandSwitch
        value={view.unmodelled_modes}
        onChange={(unmodelled_modes) => {
          onChange({ unmodelled_modes });
        }}
      />
      <VariationSelect
        value={view.variation}
        onChange={(variation) => {
          onChange({ variation, runs: view.runs });
        }}
      />
      <NumberField
        label="Fuel [%]"
        placeholder={result && percent(result.fuel_fraction)}
        min={0}
        max={100}
        value={view.fuel}
        onChange={(value) => {
          onChange({ fuel: value });
        }}
      />
      <NumberField
        label="Altitude"
        unit="m"
        description="Standard atmosphere; default: density of the fastest point"
        min={-1000}
        max={11000}
        value={view.altitude}
        onChange={(value) => {
          onChange({ altitude: value });
        }}
      />
      {tab === "closed-loop" && (
        <NewController
          onSaved={(id) => {
            onChange({ controller: id });
          }}
        />
      )}
    </Stack>
  );
}

/** The fastest point flown, and the mode participation of the mechanism. */
function mechanismText(result: Flutter): string {
  if (result.margin === null) return "";
  const parts = result.participation
    .filter((one) => one.share >= 0.01)
    .map((one) => `${one.name} ${percent(one.share)} %`);
  return ` Fastest point flown: ${fixed(result.tested_m_s, 1)} m/s. Mode participation: ${parts.join(", ")}.`;
}

function Prediction({ result }: { result: Flutter }) {
  const safe = result.safe;
  return (
    <>
      <Alert
        color={safe ? "green" : "red.9"}
        variant={safe ? "light" : "filled"}
        role={safe ? "status" : "alert"}
        title={<Sentence text={result.test_point_margin} />}
        data-testid="next-point"
        styles={{ title: safe ? { color: "var(--mantine-color-text)" } : {} }}
      >
        <Sentence text={result.sentence} /> At {percent(result.fuel_fraction)} % fuel and an air
        density of <Quantity value={result.density_kg_m3} unit="kg/m3" decimals={3} named />.
        <Sentence text={mechanismText(result)} />
      </Alert>
      <Section
        title="Model structures"
        note="Preferred structure in bold; the spread of the others widens the interval"
      >
        <Structures result={result} />
      </Section>
      <DerivedRuns runs={result.derived_runs} />
    </>
  );
}

interface DetailsProps {
  result: Flutter;
  shown: Record<string, QueryValue>;
}

/** Each run alone, classical flutter prediction methods, modes in air and in vacuo. */
function Details({ result, shown }: DetailsProps) {
  return (
    <>
      <Section
        title="Runs"
        note="Each run alone; separation is elastic over short-period frequency, decoupled from 5"
      >
        <Runs result={result} />
      </Section>
      <Section
        title="Flutter prediction methods"
        note="Classical methods from the same runs, without a structural model"
      >
        <Methods result={result} />
      </Section>
      {result.equivalents.length > 0 && (
        <Section
          title="In-vacuo modes"
          note="Linear fits of equivalent modes over dynamic pressure, ±2σ"
        >
          <Equivalents result={result} />
        </Section>
      )}
      <div className="panel" style={{ padding: 12 }}>
        <Figure
          kind="equivalent-modes"
          title="Equivalent modes over dynamic pressure, ±2σ"
          params={shown}
        />
      </div>
    </>
  );
}

function describeUnmodelledModes(one: Flutter["structures"][number]): string {
  const held = one.held_modes.join(" ");
  const from = one.source === null ? "fixed as in the runs" : `predicted by ${one.source}`;
  const parts = [
    one.nuisance_modes.length > 0 && `${one.nuisance_modes.join(" ")} as nuisance parameters`,
    held && `${held} ${from}`,
    one.unmodelled_modes.length > 0 && `${one.unmodelled_modes.join(" ")} unmodelled`,
    one.check && "one mode fewer, second fit",
  ];
  return parts.filter(Boolean).join(", ") || "–";
}

function Structures({ result }: { result: Flutter }) {
  const columns: Column<Flutter["structures"][number]>[] = [
    {
      key: "modes",
      header: "Modes estimated",
      render: (one) => {
        const modes = one.modes.join(" ") || "rigid body only";
        return one.preferred ? <strong>{modes}</strong> : modes;
      },
    },
    { key: "others", header: "Other modes", wraps: true, render: describeUnmodelledModes },
    numeric("runs", "Runs", (one) => one.run_ids.length),
    FLUTTER,
    quantity(
      "frequency",
      "Frequency",
      ({ frequency_rad_s: omega }) => omega && hertz(omega),
      "Hz",
      3,
    ),
  ];
  return (
    <DataTable
      label="Flutter by modes estimated"
      testId="structures"
      columns={columns}
      rows={result.structures}
      rowKey={(one) => [one.run_ids, one.modes, one.held_modes, one.source].join("; ")}
    />
  );
}

/** The flutter speed with its interval, or why there is none. */
const FLUTTER: Column<{
  airspeed_m_s: number | null;
  airspeed_std_m_s: number | null;
  sentence: string;
}> = {
  key: "flutter",
  header: "Flutter ±2σ",
  unit: <UnitName unit="m/s" />,
  numeric: true,
  render: (one) =>
    one.airspeed_m_s === null ? (
      <Sentence text={one.sentence} />
    ) : (
      <WithInterval
        value={one.airspeed_m_s}
        std={one.airspeed_std_m_s ?? 0}
        unit="m/s"
        decimals={2}
      />
    ),
};

function Runs({ result }: { result: Flutter }) {
  const columns: Column<Flutter["runs"][number]>[] = [
    {
      key: "run",
      header: "Run",
      render: (run) => (
        <Link to="/runs/$id" params={{ id: run.run_id }} className="link">
          {run.run_id}
        </Link>
      ),
    },
    { key: "maneuver", header: "Maneuver", render: (run) => run.label },
    quantity("airspeed", "Airspeed", (run) => run.tested_m_s, "m/s", 1),
    FLUTTER,
    numeric("separation", "Separation", (run) => fixed(run.separation, 2)),
    {
      key: "adequacy",
      header: "Model adequacy",
      render: (run) => <AdequacyBadge state={run.adequacy} />,
    },
  ];
  return (
    <DataTable
      label="Flutter by run"
      testId="flutter-each-run"
      columns={columns}
      rows={result.runs}
      rowKey={(run) => run.run_id}
      maxHeight={360}
    />
  );
}

const plusMinus = (value: number, std: number, decimals: number, scale = 1) =>
  `${fixed(scale * value, decimals)} ± ${fixed(2 * scale * std, decimals)}`;

function Equivalents({ result }: { result: Flutter }) {
  const columns: Column<Flutter["equivalents"][number]>[] = [
    { key: "mode", header: "Mode", render: (one) => one.name },
    quantity("table", "Modal table", (one) => one.table_hz, "Hz", 3),
    {
      key: "frequency",
      header: "Frequency ±2σ",
      unit: <UnitName unit="Hz" />,
      numeric: true,
      render: (one) => (
        <WithInterval value={one.frequency_hz} std={one.frequency_std_hz} unit="Hz" decimals={3} />
      ),
    },
    numeric(
      "damping",
      "Damping ±2σ",
      (one) => plusMinus(one.damping, one.damping_std, 2, 100),
      "%",
    ),
    numeric("stiffness", "CQη", (one) =>
      plusMinus(one.stiffness_derivative, one.stiffness_derivative_std, 4),
    ),
    numeric("rate", "CQη̇", (one) =>
      plusMinus(one.damping_derivative, one.damping_derivative_std, 4),
    ),
  ];
  return (
    <DataTable
      label="Equivalent frequency and damping"
      testId="equivalents"
      columns={columns}
      rows={result.equivalents}
      rowKey={(one) => one.mode}
    />
  );
}

function Methods({ result }: { result: Flutter }) {
  const before = {
    name: "Prediction before flight",
    airspeed_m_s: result.predicted_flutter_m_s,
    sentence: "",
  };
  const columns: Column<typeof before>[] = [
    { key: "method", header: "Method", render: (one) => one.name },
    quantity("flutter", "Flutter", (one) => one.airspeed_m_s, "m/s", 2),
    {
      key: "basis",
      header: "Basis",
      wraps: true,
      render: (one) => <Sentence text={one.sentence} />,
    },
  ];
  return (
    <DataTable
      label="Flutter by classical methods"
      columns={columns}
      rows={[...result.trackers, before]}
      rowKey={(one) => one.name}
    />
  );
}

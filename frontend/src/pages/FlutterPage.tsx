import {
  Alert,
  Group,
  MultiSelect,
  NumberInput,
  SegmentedControl,
  Select,
  Stack,
  Table,
  Text,
} from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import {
  flutterResult,
  predictedFlutterResult,
  predictionsQuery,
  runsQuery,
  type FlutterParams,
} from "../api/queries";
import type { QueryValue } from "../api/client";
import type { Flutter } from "../api/types";
import { useStoredResult } from "../api/useStoredResult";
import { ButtonLink } from "../components/ButtonLink";
import { DerivedRuns } from "../components/DerivedRuns";
import { OutOfBandSwitch } from "../components/OutOfBandSwitch";
import { ApprovedModelNote } from "../components/ApprovedModelNote";
import { useDefaultRuns } from "../components/useDefaultRuns";
import { VariationSelect } from "../components/VariationSelect";
import { ComputeButton } from "../components/ComputeButton";
import { Empty } from "../components/Empty";
import { Figure } from "../components/Figure";
import { JobWait } from "../components/JobWait";
import { Loaded } from "../components/Loaded";
import { AdequacyBadge } from "../components/ModelAdequacy";
import { PageHead } from "../components/PageHead";
import { StoredPredictedFlutter } from "../components/PredictedFlutter";
import { ProblemAlert } from "../components/ProblemAlert";
import { Quantity, UnitName, WithInterval } from "../components/Quantity";
import { ReportMenu } from "../components/ReportMenu";
import { Section } from "../components/Section";
import { fixed, percent } from "../lib/format";
import { integers } from "../lib/urlState";
import type { FlutterView } from "../views";

const route = getRouteApi("/flutter");

const ALONG = [
  { value: "airspeed", label: "Airspeed" },
  { value: "dynamic_pressure", label: "Dynamic pressure" },
  { value: "fuel", label: "Fuel" },
];

/** Flutter prediction of the identified models, and the margin of the next test point. */
export function FlutterPage() {
  const search = route.useSearch();
  const { view, approved } = useDefaultRuns(search, search.prediction === undefined);
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
  const { result, jobId, error, onEnd, compute } = useStoredResult(flutterResult(query));
  const ready = result.data !== undefined;
  const alone = runs.length === 0 && view.prediction !== undefined;
  // Beside flight: at the same loading, air density and airspeeds.
  const beside = result.data && {
    fuel: result.data.fuel_fraction,
    density_kg_m3: result.data.density_kg_m3,
    from_m_s: result.data.searched_from_m_s,
    to_m_s: result.data.searched_to_m_s,
  };
  const others = alone ? { fuel: query.fuel } : beside;
  const ofPrediction =
    view.prediction === undefined || others === undefined
      ? undefined
      : { prediction_id: view.prediction, ...others };
  const predicted = useStoredResult(predictedFlutterResult(ofPrediction));
  const change = (part: Partial<FlutterView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });
  return (
    <>
      <PageHead
        title="Flutter"
        trail={[
          <Link to="/campaign" className="link" key="campaign">
            Campaign
          </Link>,
        ]}
        actions={
          <>
            {ready && <ReportMenu of="flutter" query={query} />}
            <ButtonLink
              variant="default"
              to="/closed-loop"
              search={{
                runs: view.runs,
                fuel: view.fuel,
                altitude: view.altitude,
                unmodelled_modes: view.unmodelled_modes,
                variation: view.variation,
              }}
            >
              Closed loop
            </ButtonLink>
          </>
        }
      />
      <div className="split">
        <Choices view={view} result={result.data} onChange={change} />
        {alone ? (
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
              Select succeeded runs, preferably at several airspeeds. Runs of one model structure
              are fused; other structures show the sensitivity to the structure. A prediction alone
              gives flutter without flight.
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
            {ready && view.prediction !== undefined && (
              <StoredPredictedFlutter stored={predicted} />
            )}
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
        )}
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

interface ChoicesProps {
  view: FlutterView;
  result: Flutter | undefined;
  onChange: (change: Partial<FlutterView>) => void;
}

function Choices({ view, result, onChange }: ChoicesProps) {
  const runs = useQuery(runsQuery({ state: "succeeded" }));
  const predictions = useQuery(predictionsQuery());
  const typed = (value: string | number) => (typeof value === "number" ? value : undefined);
  return (
    <Stack gap="md">
      <MultiSelect
        label="Runs"
        description="Method, modes and maneuver"
        searchable
        clearable
        hidePickedOptions
        maxDropdownHeight={320}
        data-testid="flutter-runs"
        data={(runs.data ?? []).map((run) => {
          const ratio = run.airspeed_ratio;
          const at = ratio == null ? "" : `, ${fixed(ratio, 2)} V/Vf`;
          return {
            value: String(run.id),
            label: `${run.method} ${String(run.id)}: ${run.modes.join(" ")}, ${run.maneuver_label}${at}`,
          };
        })}
        value={(view.runs ?? []).map(String)}
        onChange={(ids) => {
          onChange({ runs: integers(ids) });
        }}
      />
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
          onChange({ prediction: id === null ? undefined : Number(id) });
        }}
      />
      <NumberInput
        label="Next test point [m/s]"
        description="Default: 3 % above the highest airspeed flown"
        placeholder={result && fixed(result.next_m_s, 1)}
        min={1}
        value={view.next ?? ""}
        onChange={(value) => {
          onChange({ next: typed(value) });
        }}
      />
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
      <NumberInput
        label="Fuel [%]"
        placeholder={result && percent(result.fuel_fraction)}
        min={0}
        max={100}
        value={view.fuel ?? ""}
        onChange={(value) => {
          onChange({ fuel: typed(value) });
        }}
      />
      <NumberInput
        label="Altitude [m]"
        description="Standard atmosphere; default: density of the fastest point"
        min={-1000}
        max={11000}
        value={view.altitude ?? ""}
        onChange={(value) => {
          onChange({ altitude: typed(value) });
        }}
      />
    </Stack>
  );
}

/** Margin of the fastest point, and the mode participation of the mechanism. */
function marginText(result: Flutter): string {
  if (result.margin === null) return "";
  const parts = result.participation
    .filter((one) => one.share >= 0.01)
    .map((one) => `${one.name} ${percent(one.share)} %`);
  return ` The fastest point flown, ${fixed(result.tested_m_s, 1)} m/s, has a margin of ${fixed(100 * result.margin, 1)} %. Mode participation: ${parts.join(", ")}.`;
}

function Prediction({ result }: { result: Flutter }) {
  const safe = result.safe;
  return (
    <>
      <Alert
        color={safe ? "green" : "red.9"}
        variant={safe ? "light" : "filled"}
        role={safe ? "status" : "alert"}
        title={result.test_point_margin}
        data-testid="next-point"
        styles={{ title: safe ? { color: "var(--mantine-color-text)" } : {} }}
      >
        {result.sentence} At {percent(result.fuel_fraction)} % fuel and an air density of{" "}
        {fixed(result.density_kg_m3, 3)} kg/m³.{marginText(result)}
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
  return (
    <Table className="numbers" fz="sm" data-testid="structures">
      <Table.Thead>
        <Table.Tr>
          <Table.Th>Modes estimated</Table.Th>
          <Table.Th>Other modes</Table.Th>
          <Table.Th ta="right">Runs</Table.Th>
          <Table.Th ta="right">
            Flutter ±2σ [<UnitName unit="m/s" />]
          </Table.Th>
          <Table.Th ta="right">Frequency [rad/s]</Table.Th>
        </Table.Tr>
      </Table.Thead>
      <Table.Tbody>
        {result.structures.map((one) => (
          <Table.Tr
            key={[one.run_ids, one.modes, one.held_modes, one.source].join("; ")}
            fw={one.preferred ? 600 : undefined}
          >
            <Table.Td>{one.modes.join(" ") || "rigid body only"}</Table.Td>
            <Table.Td>{describeUnmodelledModes(one)}</Table.Td>
            <Table.Td ta="right">{one.run_ids.length}</Table.Td>
            <Table.Td ta="right">
              {one.airspeed_m_s === null ? (
                one.sentence
              ) : (
                <WithInterval
                  value={one.airspeed_m_s}
                  std={one.airspeed_std_m_s ?? 0}
                  unit="m/s"
                  decimals={2}
                />
              )}
            </Table.Td>
            <Table.Td ta="right">{fixed(one.frequency_rad_s, 2)}</Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}

function Runs({ result }: { result: Flutter }) {
  return (
    <Table.ScrollContainer minWidth={420} mah={360} type="native">
      <Table className="numbers" fz="sm" data-testid="flutter-each-run">
        <Table.Thead>
          <Table.Tr>
            <Table.Th>Run</Table.Th>
            <Table.Th>Maneuver</Table.Th>
            <Table.Th ta="right">
              Airspeed [<UnitName unit="m/s" />]
            </Table.Th>
            <Table.Th ta="right">
              Flutter ±2σ [<UnitName unit="m/s" />]
            </Table.Th>
            <Table.Th ta="right">Separation</Table.Th>
            <Table.Th>Model adequacy</Table.Th>
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {result.runs.map((run) => (
            <Table.Tr key={run.run_id}>
              <Table.Td>
                <Link to="/runs/$id" params={{ id: run.run_id }} className="link">
                  {run.run_id}
                </Link>
              </Table.Td>
              <Table.Td>{run.label}</Table.Td>
              <Table.Td ta="right">
                <Quantity value={run.tested_m_s} unit="m/s" decimals={1} />
              </Table.Td>
              <Table.Td ta="right">
                {run.airspeed_m_s === null ? (
                  run.sentence
                ) : (
                  <WithInterval
                    value={run.airspeed_m_s}
                    std={run.airspeed_std_m_s ?? 0}
                    unit="m/s"
                    decimals={2}
                  />
                )}
              </Table.Td>
              <Table.Td ta="right">{fixed(run.separation, 2)}</Table.Td>
              <Table.Td>
                <AdequacyBadge state={run.adequacy} />
              </Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </Table.ScrollContainer>
  );
}

const plusMinus = (value: number, std: number, decimals: number, scale = 1) =>
  `${fixed(scale * value, decimals)} ± ${fixed(2 * scale * std, decimals)}`;

function Equivalents({ result }: { result: Flutter }) {
  return (
    <>
      <Table className="numbers" fz="sm" data-testid="equivalents">
        <Table.Thead>
          <Table.Tr>
            <Table.Th>Mode</Table.Th>
            <Table.Th ta="right">
              Modal table [<UnitName unit="Hz" />]
            </Table.Th>
            <Table.Th ta="right">
              Frequency [<UnitName unit="Hz" />]
            </Table.Th>
            <Table.Th ta="right">Damping [%]</Table.Th>
            <Table.Th ta="right">CQη</Table.Th>
            <Table.Th ta="right">CQη̇</Table.Th>
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {result.equivalents.map((line) => (
            <Table.Tr key={line.mode}>
              <Table.Td>{line.name}</Table.Td>
              <Table.Td ta="right">
                <Quantity value={line.table_hz} unit="Hz" decimals={3} />
              </Table.Td>
              <Table.Td ta="right">
                <WithInterval
                  value={line.frequency_hz}
                  std={line.frequency_std_hz}
                  unit="Hz"
                  decimals={3}
                />
              </Table.Td>
              <Table.Td ta="right">{plusMinus(line.damping, line.damping_std, 2, 100)}</Table.Td>
              <Table.Td ta="right">
                {plusMinus(line.stiffness_derivative, line.stiffness_derivative_std, 4)}
              </Table.Td>
              <Table.Td ta="right">
                {plusMinus(line.damping_derivative, line.damping_derivative_std, 4)}
              </Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </>
  );
}

function Methods({ result }: { result: Flutter }) {
  return (
    <Table className="numbers" fz="sm">
      <Table.Thead>
        <Table.Tr>
          <Table.Th>Method</Table.Th>
          <Table.Th ta="right">
            Flutter [<UnitName unit="m/s" />]
          </Table.Th>
          <Table.Th>Basis</Table.Th>
        </Table.Tr>
      </Table.Thead>
      <Table.Tbody>
        {result.trackers.map((tracker) => (
          <Table.Tr key={tracker.name}>
            <Table.Td>{tracker.name}</Table.Td>
            <Table.Td ta="right">
              <Quantity value={tracker.airspeed_m_s} unit="m/s" decimals={2} />
            </Table.Td>
            <Table.Td>
              <Text size="sm" className="quiet">
                {tracker.sentence}
              </Text>
            </Table.Td>
          </Table.Tr>
        ))}
        <Table.Tr>
          <Table.Td>Prediction before flight</Table.Td>
          <Table.Td ta="right">
            <Quantity value={result.predicted_flutter_m_s} unit="m/s" decimals={2} />
          </Table.Td>
          <Table.Td />
        </Table.Tr>
      </Table.Tbody>
    </Table>
  );
}

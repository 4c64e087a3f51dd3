import {
  Alert,
  Group,
  MultiSelect,
  NumberInput,
  SegmentedControl,
  Stack,
  Switch,
  Table,
  Text,
} from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useState } from "react";
import { flutterQuery, flutterTaskQuery, runsQuery, type FlutterQuestion } from "../api/queries";
import type { QueryValue } from "../api/client";
import type { Flutter } from "../api/types";
import { ButtonLink } from "../components/ButtonLink";
import { CarrySwitch } from "../components/CarrySwitch";
import { Empty } from "../components/Empty";
import { Figure } from "../components/Figure";
import { Loaded } from "../components/Loaded";
import { PageHead } from "../components/PageHead";
import { ProblemAlert } from "../components/ProblemAlert";
import { Section } from "../components/Section";
import { TaskProgress } from "../components/TaskProgress";
import { fixed, percent } from "../lib/format";
import { integers } from "../lib/urlState";
import type { FlutterView } from "../views";

const route = getRouteApi("/flutter");

/** More runs than these take seconds: their answer is found as a task. */
const FEW = 6;

const ALONG = [
  { value: "airspeed", label: "Airspeed" },
  { value: "dynamic_pressure", label: "Dynamic pressure" },
  { value: "fuel", label: "Fuel" },
];

/** What the identified models say of the next test point. */
export function FlutterPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const runs = view.runs ?? [];
  const question = {
    run_ids: runs.join(","),
    fuel: view.fuel === undefined ? undefined : view.fuel / 100,
    altitude_m: view.altitude,
    next_m_s: view.next,
    others: view.others,
    trend: view.trend,
  };
  const many = runs.length > FEW;
  const task = useQuery(flutterTaskQuery(question, many));
  const [found, setFound] = useState("");
  const ready = !many || found === task.data?.id;
  const answer = useQuery(flutterQuery(question, ready));
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
          <ButtonLink
            variant="default"
            to="/closed-loop"
            search={{
              runs: view.runs,
              fuel: view.fuel,
              altitude: view.altitude,
              others: view.others,
            }}
          >
            With a controller
          </ButtonLink>
        }
      />
      <div className="split">
        <Choices view={view} answer={answer.data} onChange={change} />
        {runs.length === 0 ? (
          <div className="panel">
            <Empty title="No runs chosen">
              Choose runs that succeeded, best over several airspeeds. Runs of one model structure
              are fused; other structures tell how much the structure matters.
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
              <Loaded query={answer} rows={6}>
                {(data) => <Answer answer={data} />}
              </Loaded>
            )}
            {ready && (
              <Figures
                question={question}
                along={view.along}
                onAlong={(along) => {
                  change({ along });
                }}
              />
            )}
            {ready && answer.data !== undefined && (
              <Details answer={answer.data} shown={question} />
            )}
          </Stack>
        )}
      </div>
    </>
  );
}

interface FiguresProps {
  question: FlutterQuestion;
  along: FlutterView["along"];
  onAlong: (along: FlutterView["along"]) => void;
}

function Figures({ question, along, onAlong }: FiguresProps) {
  const shown = { ...question };
  const roots = { ...question, along };
  return (
    <>
      <div className="panel" style={{ padding: 12 }}>
        <Group gap="xs" mb="xs">
          <Text size="sm">Roots along</Text>
          <SegmentedControl
            size="xs"
            aria-label="Roots along"
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
  answer: Flutter | undefined;
  onChange: (change: Partial<FlutterView>) => void;
}

function Choices({ view, answer, onChange }: ChoicesProps) {
  const runs = useQuery(runsQuery({ state: "succeeded" }));
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
      <NumberInput
        label="Next point [m/s]"
        description="3 % above the fastest flown by default"
        placeholder={answer && fixed(answer.next_m_s, 1)}
        min={1}
        value={view.next ?? ""}
        onChange={(value) => {
          onChange({ next: typed(value) });
        }}
      />
      <CarrySwitch
        others={view.others}
        onChange={(others) => {
          onChange({ others });
        }}
      />
      <Switch
        label="Derivatives drift with dynamic pressure"
        description="For structures that leave modes out; a line takes three dynamic pressures and costs precision"
        checked={view.trend === true}
        onChange={(event) => {
          onChange({ trend: event.currentTarget.checked ? true : undefined });
        }}
      />
      <NumberInput
        label="Fuel [%]"
        placeholder={answer && percent(answer.fuel_fraction)}
        min={0}
        max={100}
        value={view.fuel ?? ""}
        onChange={(value) => {
          onChange({ fuel: typed(value) });
        }}
      />
      <NumberInput
        label="Altitude [m]"
        description="Standard atmosphere; the air of the fastest point by default"
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

/** Margin of the fastest point, and the motions that take part in the mechanism. */
function whatMoves(answer: Flutter): string {
  if (answer.margin === null) return "";
  const parts = answer.participation
    .filter((one) => one.share >= 0.01)
    .map((one) => `${one.name} ${percent(one.share)} %`);
  return ` The fastest point flown, ${fixed(answer.tested_m_s, 1)} m/s, has a margin of ${fixed(100 * answer.margin, 1)} %. What moves: ${parts.join(", ")}.`;
}

function Answer({ answer }: { answer: Flutter }) {
  const safe = answer.safe;
  return (
    <>
      <Alert
        color={safe ? "green" : "red.9"}
        variant={safe ? "light" : "filled"}
        role={safe ? "status" : "alert"}
        title={answer.next_point}
        data-testid="next-point"
        styles={{ title: safe ? { color: "var(--mantine-color-text)" } : {} }}
      >
        {answer.sentence} At {percent(answer.fuel_fraction)} % fuel and an air density of{" "}
        {fixed(answer.density_kg_m3, 3)} kg/m³.{whatMoves(answer)}
      </Alert>
      <Section
        title="Model structures"
        note="Bold is preferred; how the others differ widens the interval"
      >
        <Structures answer={answer} />
      </Section>
    </>
  );
}

interface DetailsProps {
  answer: Flutter;
  shown: Record<string, QueryValue>;
}

/** What else the runs say: trackers, each run alone, modes in air and without. */
function Details({ answer, shown }: DetailsProps) {
  return (
    <>
      <Section
        title="Runs"
        note="Each alone; elastic over short-period frequency, of which five counts as decoupled"
      >
        <Runs answer={answer} />
      </Section>
      <Section
        title="Classical trackers"
        note="From the same runs, without a model of the structure"
      >
        <Trackers answer={answer} />
      </Section>
      {answer.equivalents.length > 0 && (
        <Section
          title="Modes without air"
          note="Straight lines through equivalent modes over dynamic pressure, ±2σ"
        >
          <Equivalents answer={answer} />
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

function othersOf(one: Flutter["structures"][number]): string {
  const held = one.held_modes.join(" ");
  const from = one.source === null ? "as the runs hold them" : `as predicted by ${one.source}`;
  const told = [
    held && `${held} ${from}`,
    one.left_out_modes.length > 0 && `${one.left_out_modes.join(" ")} left out`,
    one.check && "one mode fewer, in a second fit",
  ];
  return told.filter(Boolean).join(", ") || "–";
}

function Structures({ answer }: { answer: Flutter }) {
  return (
    <Table className="numbers" fz="sm" data-testid="structures">
      <Table.Thead>
        <Table.Tr>
          <Table.Th>Modes estimated</Table.Th>
          <Table.Th>Other modes</Table.Th>
          <Table.Th ta="right">Runs</Table.Th>
          <Table.Th ta="right">Flutter ±2σ [m/s]</Table.Th>
          <Table.Th ta="right">Frequency [rad/s]</Table.Th>
        </Table.Tr>
      </Table.Thead>
      <Table.Tbody>
        {answer.structures.map((one) => (
          <Table.Tr
            key={[one.run_ids, one.modes, one.held_modes, one.source].join("; ")}
            fw={one.preferred ? 600 : undefined}
          >
            <Table.Td>{one.modes.join(" ") || "rigid only"}</Table.Td>
            <Table.Td>{othersOf(one)}</Table.Td>
            <Table.Td ta="right">{one.run_ids.length}</Table.Td>
            <Table.Td ta="right">
              {one.airspeed_m_s === null
                ? one.sentence
                : `${fixed(one.airspeed_m_s, 2)} ± ${fixed(2 * (one.airspeed_std_m_s ?? 0), 2)}`}
            </Table.Td>
            <Table.Td ta="right">{fixed(one.frequency_rad_s, 2)}</Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}

function Runs({ answer }: { answer: Flutter }) {
  return (
    <Table.ScrollContainer minWidth={420} mah={360} type="native">
      <Table className="numbers" fz="sm" data-testid="flutter-each-run">
        <Table.Thead>
          <Table.Tr>
            <Table.Th>Run</Table.Th>
            <Table.Th>Maneuver</Table.Th>
            <Table.Th ta="right">Flown [m/s]</Table.Th>
            <Table.Th ta="right">Flutter ±2σ [m/s]</Table.Th>
            <Table.Th ta="right">Separation</Table.Th>
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {answer.runs.map((run) => (
            <Table.Tr key={run.run_id}>
              <Table.Td>
                <Link to="/runs/$id" params={{ id: run.run_id }} className="link">
                  {run.run_id}
                </Link>
              </Table.Td>
              <Table.Td>{run.label}</Table.Td>
              <Table.Td ta="right">{fixed(run.tested_m_s, 1)}</Table.Td>
              <Table.Td ta="right">
                {run.airspeed_m_s === null
                  ? run.sentence
                  : plusMinus(run.airspeed_m_s, run.airspeed_std_m_s ?? 0, 2)}
              </Table.Td>
              <Table.Td ta="right">{fixed(run.separation, 2)}</Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </Table.ScrollContainer>
  );
}

const plusMinus = (value: number, std: number, decimals: number, scale = 1) =>
  `${fixed(scale * value, decimals)} ± ${fixed(2 * scale * std, decimals)}`;

function Equivalents({ answer }: { answer: Flutter }) {
  return (
    <>
      <Table className="numbers" fz="sm" data-testid="equivalents">
        <Table.Thead>
          <Table.Tr>
            <Table.Th>Mode</Table.Th>
            <Table.Th ta="right">Modal table [Hz]</Table.Th>
            <Table.Th ta="right">Frequency [Hz]</Table.Th>
            <Table.Th ta="right">Damping [%]</Table.Th>
            <Table.Th ta="right">CQη</Table.Th>
            <Table.Th ta="right">CQη̇</Table.Th>
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {answer.equivalents.map((line) => (
            <Table.Tr key={line.mode}>
              <Table.Td>{line.name}</Table.Td>
              <Table.Td ta="right">{fixed(line.table_hz, 3)}</Table.Td>
              <Table.Td ta="right">
                {plusMinus(line.frequency_hz, line.frequency_std_hz, 3)}
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

function Trackers({ answer }: { answer: Flutter }) {
  return (
    <Table className="numbers" fz="sm">
      <Table.Thead>
        <Table.Tr>
          <Table.Th>Tracker</Table.Th>
          <Table.Th ta="right">Flutter [m/s]</Table.Th>
          <Table.Th>How</Table.Th>
        </Table.Tr>
      </Table.Thead>
      <Table.Tbody>
        {answer.trackers.map((tracker) => (
          <Table.Tr key={tracker.name}>
            <Table.Td>{tracker.name}</Table.Td>
            <Table.Td ta="right">{fixed(tracker.airspeed_m_s, 2)}</Table.Td>
            <Table.Td>
              <Text size="sm" className="quiet">
                {tracker.sentence}
              </Text>
            </Table.Td>
          </Table.Tr>
        ))}
        <Table.Tr>
          <Table.Td>Predicted before flight</Table.Td>
          <Table.Td ta="right">{fixed(answer.known_m_s, 2)}</Table.Td>
          <Table.Td />
        </Table.Tr>
      </Table.Tbody>
    </Table>
  );
}

import { Button, Group, Menu, SegmentedControl, Switch, Text } from "@mantine/core";
import { useHotkeys } from "@mantine/hooks";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useState } from "react";
import { address } from "../api/client";
import {
  conditionSheetQuery,
  conditionsQuery,
  flutterResult,
  frozenFigureQuery,
  maneuverQuery,
} from "../api/queries";
import { crossPredictionResult } from "../api/queries/validation";
import type { ConditionSheet } from "../api/types";
import { useStoredResult } from "../api/useStoredResult";
import { ReviewPart, ReviewSummary } from "../components/conditions/ReviewPart";
import { SelectedDerivative, useSensors } from "../components/conditions/SelectedDerivative";
import { ButtonLink } from "../components/controls/ButtonLink";
import { DerivativeName } from "../components/display/DerivativeName";
import { Loaded } from "../components/display/Loaded";
import { Quantity } from "../components/display/Quantity";
import { Figure } from "../components/figures/Figure";
import { PageHead } from "../components/frame/PageHead";
import { JobWait } from "../components/jobs/JobWait";
import { dateMinute, fixed, percent } from "../lib/text/format";
import type { ConditionView } from "../views";
import { conditionName } from "./ConditionsPage";

/** Figures take the width of the paper before it is printed. */
const RESIZE_MS = 1500;

/** Path, suffix and label of what a sheet is exported as. */
const EXPORTS = [
  ["derivatives", "csv", "Derivatives as CSV"],
  ["sheet", "json", "Everything as JSON"],
  ["notebook", "ipynb", "Notebook (Jupyter)"],
] as const;

const route = getRouteApi("/conditions/$id");

/** Sheet of evidence of a flight condition. */
export function ConditionPage() {
  const { id } = route.useParams();
  const { truth, frozen } = route.useSearch();
  const sheet = useQuery(conditionSheetQuery(id, truth, frozen));
  return (
    <Loaded query={sheet} page="Condition" rows={14}>
      {(data) => <Sheet sheet={data} />}
    </Loaded>
  );
}

interface PartProps {
  sheet: ConditionSheet;
  view: ConditionView;
  onChange: (part: Partial<ConditionView>) => void;
}

function Sheet({ sheet }: { sheet: ConditionSheet }) {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const onChange = (part: Partial<ConditionView>) =>
    void navigate({
      search: (before) => ({ ...before, ...part }),
      replace: true,
    });
  const [isPrinting, setPrinting] = useState(false);
  const neighbours = useNeighbours(sheet);
  const names = sheet.rows.map((row) => row.name);
  const step = (by: number) => {
    const at = names.indexOf(view.selected ?? "");
    const next = names[Math.min(Math.max(at + by, 0), names.length - 1)];
    if (next !== undefined) onChange({ selected: next });
  };
  const go = (id: number | undefined) => {
    if (id !== undefined) void navigate({ to: "/conditions/$id", params: { id } });
  };
  useHotkeys([
    [
      "ArrowDown",
      () => {
        step(1);
      },
    ],
    [
      "ArrowUp",
      () => {
        step(-1);
      },
    ],
    [
      "Escape",
      () => {
        onChange({ selected: undefined });
      },
    ],
    [
      "[",
      () => {
        go(neighbours.before);
      },
    ],
    [
      "]",
      () => {
        go(neighbours.after);
      },
    ],
  ]);
  const { record, condition } = sheet;
  const title = conditionName(condition, record.fuel_fraction);
  const part = { sheet, view, onChange };
  return (
    <article className="sheet" data-testid="condition-sheet" data-printing={isPrinting}>
      <PageHead
        title={title}
        trail={[
          <Link to="/conditions" className="link" key="conditions">
            Conditions
          </Link>,
        ]}
        actions={
          <>
            {neighbours.before !== undefined && (
              <ButtonLink to="/conditions/$id" params={{ id: neighbours.before }} variant="default">
                Previous
              </ButtonLink>
            )}
            {neighbours.after !== undefined && (
              <ButtonLink to="/conditions/$id" params={{ id: neighbours.after }} variant="default">
                Next
              </ButtonLink>
            )}
            <Menu position="bottom-end">
              <Menu.Target>
                <Button variant="default">Export</Button>
              </Menu.Target>
              <Menu.Dropdown>
                {EXPORTS.map(([path, suffix, label]) => (
                  <Menu.Item
                    key={path}
                    component="a"
                    href={address(`conditions/${condition.id}/${path}`, {})}
                    download={`flexsid-condition-${condition.id}.${suffix}`}
                  >
                    {label}
                  </Menu.Item>
                ))}
              </Menu.Dropdown>
            </Menu>
            <Button
              variant="default"
              onClick={() => {
                setPrinting(true);
                window.setTimeout(() => {
                  window.print();
                  setPrinting(false);
                }, RESIZE_MS);
              }}
            >
              Print
            </Button>
          </>
        }
      />
      <div className="sheet-head">
        <div>
          <Text size="sm" className="quiet">
            Flight {record.flight_number},{" "}
            <Link to="/maneuvers/$id" params={{ id: record.maneuver_id }} className="link">
              {record.label}
            </Link>{" "}
            · <Quantity value={record.airspeed_m_s} unit="m/s" decimals={1} named /> ·{" "}
            <Quantity value={condition.dynamic_pressure_pa} unit="Pa" decimals={0} named />
            {sheet.sources
              .filter((one) => one.role === "repeat")
              .map((one) => (
                <span key={one.key}>
                  {" "}
                  · repeat {one.maneuver_label} at fuel {percent(one.fuel_fraction)} %
                </span>
              ))}
          </Text>
          <p className="sheet-verdict" data-testid="sheet-verdict">
            <Verdict sheet={sheet} /> {sheet.sentence}
          </p>
          {view.frozen === undefined ? (
            <Unfinished sheet={sheet} />
          ) : (
            <FrozenNote id={view.frozen} condition={condition.id} />
          )}
        </div>
        <ReviewSummary sheet={sheet} />
      </div>
      {sheet.reference_run_id === null ? (
        <NothingYet sheet={sheet} />
      ) : (
        <>
          <div className="sheet-columns">
            <Derivatives {...part} />
            <div className="sheet-side">
              <Responses {...part} />
              <PolesAndFlutter {...part} />
              <HeldOut {...part} />
            </div>
          </div>
          <div className="sheet-columns">
            <Correlation {...part} />
            <Adequacy {...part} />
          </div>
          <ReviewPart sheet={sheet} />
        </>
      )}
      <Foot sheet={sheet} />
    </article>
  );
}

/** Ids of the conditions before and after this one, of the same aircraft. */
function useNeighbours(sheet: ConditionSheet): { before?: number; after?: number } {
  const { data } = useQuery(conditionsQuery(sheet.condition.aircraft_id));
  const ids = (data ?? []).map((one) => one.id);
  const at = ids.indexOf(sheet.condition.id);
  return { before: at > 0 ? ids[at - 1] : undefined, after: at < 0 ? undefined : ids[at + 1] };
}

const WORDS: Record<ConditionSheet["verdict"], string> = {
  consistent: "Consistent.",
  suspect: "Suspect.",
  "not tested": "",
};

function Verdict({ sheet }: { sheet: ConditionSheet }) {
  return <strong data-state={sheet.verdict}>{WORDS[sheet.verdict]}</strong>;
}

function Unfinished({ sheet }: { sheet: ConditionSheet }) {
  const [first] = sheet.unfinished_run_ids;
  if (first === undefined) return null;
  return (
    <div className="no-print" data-testid="sheet-unfinished">
      <Text size="sm" className="quiet">
        {sheet.unfinished_run_ids.length === 1
          ? "One run is not finished; the sheet fills as its results arrive."
          : `${sheet.unfinished_run_ids.length} runs are not finished; the sheet fills as their results arrive.`}
      </Text>
    </div>
  );
}

/** States with which decision a sheet was frozen, and under which hash. */
function FrozenNote({ id, condition }: { id: number; condition: number }) {
  const { data } = useQuery(frozenFigureQuery(id));
  return (
    <Text size="sm" data-testid="sheet-frozen">
      Frozen when the decision was made
      {data !== undefined && (
        <>
          , {dateMinute(data.created_at)}, SHA-256 {data.array.slice(0, 12)}
        </>
      )}
      .{" "}
      <Link to="/conditions/$id" params={{ id: condition }} className="link no-print">
        Current sheet
      </Link>
    </Text>
  );
}

function NothingYet({ sheet }: { sheet: ConditionSheet }) {
  if (sheet.unfinished_run_ids.length > 0) return null;
  return (
    <Group my="lg">
      <ButtonLink
        to="/maneuvers/$id/new-run"
        params={{ id: sheet.record.maneuver_id }}
        search={{ methods: ["OE", "FRE", "EE"] }}
      >
        Estimate {sheet.record.label} by OE, FRE and EE
      </ButtonLink>
      <Text size="sm" className="quiet">
        About 1 min
      </Text>
    </Group>
  );
}

function Derivatives({ sheet, view, onChange }: PartProps) {
  const names = sheet.rows.map((row) => row.name);
  const runs = sheet.sources.flatMap((one) => (one.run_id === null ? [] : [one.run_id]));
  return (
    <section className="sheet-part" aria-label="Derivatives">
      <h2>
        Derivatives{" "}
        <span className="quiet">
          {names.length} free, reference {sheet.sources[0]?.label}
        </span>
      </h2>
      <Group gap="xs" className="no-print" mb={4}>
        <SegmentedControl
          size="xs"
          aria-label="Scale of the derivatives"
          data={[
            { value: "normalised", label: "Deviation in σ" },
            { value: "absolute", label: "Absolute" },
          ]}
          value={view.absolute === true ? "absolute" : "normalised"}
          onChange={(next) => {
            onChange({ absolute: next === "absolute" ? true : undefined });
          }}
        />
        {sheet.has_truth && view.frozen === undefined && (
          <Switch
            size="xs"
            label="Show the truth"
            checked={view.truth === true}
            onChange={(event) => {
              onChange({ truth: event.currentTarget.checked || undefined });
            }}
          />
        )}
        <Text size="xs" className="quiet">
          Press a row to emphasise it everywhere; ↑ ↓ move, Esc clears.
        </Text>
      </Group>
      {view.absolute === true ? (
        [...new Set(names.map((name) => name.split("_")[0] ?? ""))].map((one) => (
          <Figure
            key={one}
            kind="derivatives"
            title={`Derivatives of ${one} with ±2σ, each at the fuel of its record`}
            params={{ run_ids: runs, prediction_ids: sheet.prediction_ids, coefficient: one }}
          />
        ))
      ) : (
        <Figure
          kind="condition-derivatives"
          params={{
            condition_id: sheet.condition.id,
            selected: view.selected,
            truth: view.truth,
            figure_id: view.frozen,
          }}
          revision="rows"
          onPick={(row) => {
            const name = names[row];
            onChange({ selected: name === view.selected ? undefined : name });
          }}
        />
      )}
      {sheet.n_true > 0 && (
        <p className="sheet-note" data-testid="sheet-truth">
          The truth of this simulated aircraft lies inside ±2σ of {sheet.sources[0]?.label} in{" "}
          {sheet.n_inside} of {sheet.n_true} derivatives.
        </p>
      )}
      <SelectedDerivative sheet={sheet} name={view.selected} />
      <p className="sheet-note">{sheet.note}</p>
    </section>
  );
}

/** Two outputs of a figure: the first one, and the sensor that informs the pressed derivative. */
const shownOutputs = ({ outputs }: ConditionSheet, sensor: string | undefined) => [
  ...new Set([...outputs.slice(0, 1), sensor ?? outputs.at(-1) ?? ""]),
];

function Responses({ sheet, view, onChange }: PartProps) {
  const sensor = useSensors(sheet, view.selected).sensors[0]?.output;
  const selected = (view.selected ?? "").split("_")[1] ?? "";
  const chosen = [view.input, selected].find((one) => sheet.inputs.includes(one ?? ""));
  const input = chosen ?? sheet.inputs.at(-1);
  if (input === undefined || sheet.outputs.length === 0) return null;
  const shown = shownOutputs(sheet, sensor);
  const row = sheet.rows.find((one) => one.name === view.selected);
  const estimated = row?.std_error != null;
  return (
    <section className="sheet-part" aria-label="Frequency responses">
      <h2>
        Response to {input} <span className="quiet">dots measured ±2σ, line the model</span>
      </h2>
      <SegmentedControl
        className="no-print"
        size="xs"
        aria-label="Input"
        data={sheet.inputs}
        value={input}
        onChange={(next) => {
          onChange({ input: next });
        }}
      />
      <Figure
        kind="bode"
        height={540}
        params={{
          maneuver_id: sheet.record.maneuver_id,
          output: shown,
          inputs: [input],
          run_id: sheet.reference_run_id,
          selected: estimated ? view.selected : undefined,
        }}
      />
    </section>
  );
}

function PolesAndFlutter({ sheet }: PartProps) {
  const run = String(sheet.reference_run_id);
  const { result, jobId, onEnd } = useStoredResult(flutterResult({ run_ids: run }));
  return (
    <section className="sheet-part" aria-label="Poles and flutter">
      <h2>
        Poles and flutter <span className="quiet">constant derivatives, bands ±2σ</span>
      </h2>
      {jobId !== undefined && <JobWait key={jobId} id={jobId} onEnd={onEnd} />}
      {result.data !== undefined && (
        <>
          <Text size="sm">{result.data.test_point_margin}</Text>
          <Figure kind="v-omega-zeta" height={330} params={{ run_ids: [Number(run)] }} />
        </>
      )}
    </section>
  );
}

function HeldOut({ sheet, view }: PartProps) {
  const sensor = useSensors(sheet, view.selected).sensors[0]?.output;
  const [first] = sheet.held_out;
  const options = crossPredictionResult({
    run_ids: first === undefined ? "" : String(sheet.reference_run_id),
    maneuver_ids: String(first?.maneuver_id ?? ""),
  });
  const { result } = useStoredResult(options);
  const repeat = useQuery({
    ...maneuverQuery(first?.maneuver_id ?? 0),
    enabled: first !== undefined,
  });
  const start = repeat.data?.start_s;
  if (first === undefined) {
    return (
      <section className="sheet-part" aria-label="Held-out prediction">
        <h2>Held-out prediction</h2>
        <Text size="sm">No repeat of this condition: nothing on this sheet was held out.</Text>
      </section>
    );
  }
  const worst = result.data?.predictions[0]?.outputs.reduce((a, b) =>
    b.r_squared < a.r_squared ? b : a,
  );
  return (
    <section className="sheet-part" aria-label="Held-out prediction">
      <h2>
        Held-out prediction{" "}
        <span className="quiet">
          {first.label} by the model of {sheet.record.label}
        </span>
      </h2>
      {worst !== undefined && (
        <Text size="sm">
          R² of {result.data?.predictions[0]?.outputs.length} outputs, lowest{" "}
          {fixed(worst.r_squared, 3)} ({worst.output})
        </Text>
      )}
      <Figure
        kind="time-check"
        height={280}
        params={{
          run_id: sheet.reference_run_id,
          maneuver_id: first.maneuver_id,
          outputs: shownOutputs(sheet, sensor),
        }}
        window={start === undefined ? undefined : [start + 5, start + 13]}
      />
    </section>
  );
}

function Correlation({ sheet, view, onChange }: PartProps) {
  return (
    <section className="sheet-part" aria-label="Correlation">
      <h2>
        Correlation of the estimates <span className="quiet">{sheet.n_pairs} pairs</span>
      </h2>
      <div className="sheet-correlation">
        <Figure
          kind="parameter-correlation"
          height={380}
          params={{ run_id: sheet.reference_run_id, selected: view.selected, grouped: true }}
          revision="correlation"
        />
        <div>
          <h3>Largest |ρ|, limit 0.9</h3>
          <ol className="sheet-pairs">
            {sheet.pairs.map((pair) => (
              <li key={`${pair.first} ${pair.second}`}>
                <button
                  type="button"
                  onClick={() => {
                    onChange({ selected: pair.first });
                  }}
                >
                  <DerivativeName name={pair.first} />, <DerivativeName name={pair.second} />
                </button>
                <span className="numbers">{fixed(pair.correlation, 2)}</span>
                <span
                  className="sheet-bar"
                  data-sign={pair.correlation < 0 ? "minus" : "plus"}
                  style={{ width: `${60 * Math.abs(pair.correlation)}px` }}
                />
              </li>
            ))}
          </ol>
        </div>
      </div>
    </section>
  );
}

function Adequacy({ sheet, view }: PartProps) {
  const sensor = useSensors(sheet, view.selected).sensors[0]?.output;
  const [own, ...others] = sheet.adequacy;
  if (own === undefined) return null;
  return (
    <section className="sheet-part" aria-label="Adequacy">
      <h2>
        Adequacy{" "}
        <span className="quiet">
          {own.n_tests} tests, one mark each
          {sensor !== undefined && <>; wide: {sensor}, which informs the pressed derivative most</>}
        </span>
      </h2>
      <Figure
        kind="adequacy"
        params={{ run_id: own.run_id, selected: sensor }}
        revision="adequacy"
      />
      {own.smallest !== null && (
        <Text size="sm">
          Smallest adjusted p {fixed(own.smallest.adjusted_p, 2)} ({own.smallest.hypothesis},{" "}
          {own.smallest.subject}).{" "}
          {others.map((one) => (
            <span key={one.run_id}>
              {one.method} of {one.label}: {one.n_rejected} of {one.n_tests} reject.{" "}
            </span>
          ))}
        </Text>
      )}
    </section>
  );
}

function Foot({ sheet }: { sheet: ConditionSheet }) {
  const runs = sheet.sources.flatMap((one) =>
    one.run_id === null ? [] : [`${one.method} run ${one.run_id}`],
  );
  const versions = Object.entries(sheet.versions)
    .filter(([name]) => name === "flexsid" || name === "methods")
    .map(([name, version]) => `${name} ${version}`);
  const parts = [
    ...runs,
    sheet.data_hash === null ? "" : `data ${sheet.data_hash.slice(0, 11)}`,
    sheet.input_hash === null ? "" : `input ${sheet.input_hash.slice(0, 11)}`,
    ...versions,
    dateMinute(new Date().toISOString()),
  ];
  return <footer className="sheet-foot">{parts.filter((one) => one !== "").join(" · ")}</footer>;
}

import { Button, Group, Select, Stack, Text, TextInput } from "@mantine/core";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useState } from "react";
import { address } from "../api/client";
import { useSaveGlobalPrediction } from "../api/commands";
import { globalModelResult } from "../api/queries";
import type { GlobalModelSummary } from "../api/types";
import { useStoredResult } from "../api/useStoredResult";
import { ComputeButton } from "../components/controls/ComputeButton";
import { DataTable, numeric, type Column } from "../components/controls/DataTable";
import { DerivativeName } from "../components/display/DerivativeName";
import { DerivativeSelect } from "../components/controls/DerivativeSelect";
import { Empty } from "../components/display/Empty";
import { Figure } from "../components/figures/Figure";
import {
  DEFAULT_VARIABLES,
  GlobalModelSettings,
} from "../components/predictions/GlobalModelSettings";
import { GlobalModelVersions } from "../components/predictions/GlobalModelVersions";
import { JobWait } from "../components/jobs/JobWait";
import { Loaded } from "../components/display/Loaded";
import { NumberField } from "../components/controls/NumberField";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { Section } from "../components/display/Section";
import { fixed, percent, significant, withError } from "../lib/text/format";
import { QUANTITIES } from "../lib/limits";
import { oneOf } from "../lib/urlState";
import { VARIABLES, type GlobalModelView } from "../views";

const route = getRouteApi("/global-model");

type Variable = (typeof VARIABLES)[number];
type Derivative = GlobalModelSummary["derivatives"][number];
type Score = GlobalModelSummary["scores"][number];
type Outlier = GlobalModelSummary["outliers"][number];

const LEAST_RUNS = 4;
/** Smaller probabilities are not resolved. */
const LEAST_SHOWN = 1e-9;

interface ViewProps {
  view: GlobalModelView;
  onChange: (change: Partial<GlobalModelView>) => void;
}

/** Derivatives over the envelope from all runs, with slices, coverage and outlying runs. */
export function GlobalModelPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const runs = view.runs ?? [];
  const query = {
    run_ids: runs.length < LEAST_RUNS ? "" : runs.join(","),
    variables: (view.variables ?? DEFAULT_VARIABLES).join(","),
    prediction_id: view.prediction,
  };
  const { result, jobId, error, onEnd, compute } = useStoredResult(globalModelResult(query));
  const onChange = (part: Partial<GlobalModelView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });
  return (
    <>
      <PageHead
        title="Global model"
        trail={[
          <Link to="/runs" className="link" key="runs">
            Runs
          </Link>,
        ]}
      />
      <div className="split">
        <GlobalModelSettings view={view} onChange={onChange} />
        {query.run_ids === "" || query.variables === "" ? (
          <Stack gap="md">
            <div className="panel">
              <Empty title={query.variables === "" ? "No variable selected" : "Too few runs"}>
                Select at least four succeeded runs of one model structure, best of several flights,
                airspeeds and fuel weights, and one or more variables.
              </Empty>
            </div>
            <GlobalModelVersions />
          </Stack>
        ) : (
          <Stack gap="md">
            <ComputeButton compute={compute} />
            {error !== null && <ProblemAlert error={error} />}
            {jobId !== undefined && <JobWait key={jobId} id={jobId} onEnd={onEnd} />}
            {compute === undefined && jobId === undefined && error === null && (
              <Loaded query={result} rows={6}>
                {(model) => <Model model={model} query={query} view={view} onChange={onChange} />}
              </Loaded>
            )}
          </Stack>
        )}
      </div>
    </>
  );
}

interface ModelProps extends ViewProps {
  model: GlobalModelSummary;
  query: { run_ids: string; variables: string; prediction_id?: number };
}

function Model({ model, query, view, onChange }: ModelProps) {
  return (
    <>
      <Section title="Result">
        <Text size="sm" data-testid="global-model-sentence">
          {model.sentence}
        </Text>
        {model.omitted.length > 0 && (
          <Text size="xs" className="quiet">
            Estimated by too few runs: {model.omitted.join(", ")}
          </Text>
        )}
      </Section>
      {model.outliers.length > 0 && (
        <Section title="Outlying runs" note="Not predicted by the other runs; excluded">
          <DataTable
            label="Outlying runs"
            testId="outlying-runs"
            columns={OUTLIERS}
            rows={model.outliers}
            rowKey={(row) => row.run_id}
          />
        </Section>
      )}
      <Slice model={model} query={query} view={view} onChange={onChange} />
      <GlobalModelVersions query={query} />
      <PredictionAndExport model={model} query={query} view={view} onChange={onChange} />
      <Section
        title="Derivatives"
        note="At the mean condition of the runs; slopes averaged over the runs, drift in bold"
      >
        <DataTable
          label="Derivatives"
          testId="global-derivatives"
          columns={listColumns(model)}
          rows={model.derivatives}
          rowKey={(row) => row.name}
          isSelected={(row) => row.name === view.derivative}
          maxHeight={480}
        />
      </Section>
      <Section title="Coverage" note={nextCondition(model)}>
        <Figure
          kind="global-coverage"
          title="Standard error over the envelope"
          params={{ ...query }}
        />
      </Section>
      <Section title="Prediction of flights" note="Each flight predicted by all others">
        <DataTable
          label="Prediction of flights"
          testId="global-scores"
          columns={SCORES}
          rows={model.scores}
          rowKey={(row) => `${String(row.uses_prediction)} ${String(row.degree)}`}
          isSelected={(row) => row.is_selected}
        />
      </Section>
    </>
  );
}

function Slice({ model, query, view, onChange }: ModelProps) {
  const names = model.derivatives.map((one) => one.name);
  const name = names.find((one) => one === view.derivative) ?? names[0];
  const variables = model.variables.map((one) => quantity(one.quantity));
  const along = variables.find(({ key }) => key === view.along) ?? variables[0];
  if (name === undefined || along === undefined) return <Empty title="No derivatives" />;
  const held =
    view.condition?.length === model.centre.length ? view.condition : model.centre.map(Number);
  return (
    <Section
      title="Slice"
      note="±2σ of the model and of a further run; estimates ±2σ moved along the model to the slice"
    >
      <Stack gap="sm">
        <Group gap="sm" align="end">
          <DerivativeSelect
            names={names}
            value={name}
            onChange={(derivative) => {
              onChange({ derivative });
            }}
          />
          <Select
            aria-label="Along"
            allowDeselect={false}
            w={180}
            data={variables.map(({ key, label }) => ({ value: key, label }))}
            value={along.key}
            onChange={(key) => {
              onChange({ along: oneOf(key, VARIABLES) });
            }}
          />
          {variables.map(
            ({ key, label, unit, factor }, number) =>
              key !== along.key && (
                <NumberField
                  key={key}
                  label={label}
                  unit={unit === "" ? undefined : unit}
                  aria-label={`${label} of the slice`}
                  w={150}
                  decimalScale={3}
                  value={(held[number] ?? 0) * factor}
                  onChange={(typed) => {
                    if (typed === undefined) return;
                    const condition = held.map((value, k) =>
                      k === number ? typed / factor : value,
                    );
                    onChange({ condition });
                  }}
                />
              ),
          )}
        </Group>
        <Figure
          kind="global-slice"
          title={`${name} over ${along.label.toLowerCase()}`}
          params={{ ...query, name, along: along.key, condition: held.join(",") }}
        />
      </Stack>
    </Section>
  );
}

function PredictionAndExport({ model, query, view }: ModelProps) {
  const [source, setSource] = useState("Global model");
  const save = useSaveGlobalPrediction();
  const condition = view.condition?.length === model.centre.length ? view.condition : model.centre;
  return (
    <Section
      title="Prediction from this model"
      note="A prediction at the condition of the slice, over the flown fuel weights: for priors of runs, pre-flight simulation and comparison"
    >
      <form
        onSubmit={(event) => {
          event.preventDefault();
          save.mutate({ query, request: { source, condition: condition.map(Number) } });
        }}
      >
        <Group gap="sm" align="end">
          <TextInput
            label="Name"
            required
            value={source}
            onChange={(event) => {
              setSource(event.currentTarget.value);
            }}
          />
          <Button type="submit" loading={save.isPending} data-testid="store-prediction">
            Store prediction
          </Button>
          <Button
            component="a"
            variant="default"
            href={address("global-models/dave-ml", { ...query })}
            download
          >
            Download DAVE-ML
          </Button>
        </Group>
      </form>
      {save.error !== null && <ProblemAlert error={save.error} />}
      {save.data !== undefined && (
        <Text size="sm" role="status" mt="xs">
          {save.data.source}: {save.data.note}
        </Text>
      )}
    </Section>
  );
}

function quantity(key: string) {
  const found = QUANTITIES.find((one) => one.key === key);
  return found ?? QUANTITIES[0];
}

/** Step over which a slope is shown, in SI, by variable. */
const STEPS: Record<Variable, { size: number; text: string }> = {
  dynamic_pressure_pa: { size: 100, text: "100 Pa" },
  fuel_fraction: { size: 0.1, text: "10 % fuel" },
  airspeed_m_s: { size: 1, text: "m/s" },
  airspeed_ratio: { size: 0.1, text: "0.1 V/Vf" },
  alpha_rad: { size: Math.PI / 180, text: "deg" },
};

function listColumns(model: GlobalModelSummary): Column<Derivative>[] {
  return [
    {
      key: "name",
      header: "Derivative",
      render: (row) => <DerivativeName name={row.name} />,
    },
    numeric("value", "Value ± σ", (row) => {
      const shown = withError(row.value, row.std_error);
      return `${shown.value} ± ${shown.error}`;
    }),
    numeric("scatter", "Scatter", (row) => significant(row.scatter, 2)),
    numeric("runs", "Runs", (row) => row.n_runs),
    ...model.variables.map(({ quantity: key }, number) =>
      numeric<Derivative>(key, `Slope ± σ per ${STEPS[key].text}`, (row) => {
        const slope = row.slopes[number];
        if (slope === undefined) return "–";
        const size = STEPS[key].size;
        const shown = withError(size * slope.slope, size * slope.std_error);
        const text = `${shown.value} ± ${shown.error}`;
        return slope.is_drift ? <strong title="Drift">{text}</strong> : text;
      }),
    ),
  ];
}

const OUTLIERS: Column<Outlier>[] = [
  {
    key: "run",
    header: "Run",
    render: (row) => (
      <Link to="/runs/$id" params={{ id: row.run_id }} className="link">
        {row.run_id}
      </Link>
    ),
  },
  { key: "sentence", header: "Deviation", wraps: true, render: (row) => row.sentence },
  numeric("chi", "χ²", (row) => fixed(row.chi_square, 0)),
  numeric("n", "Derivatives", (row) => row.n_derivatives),
  numeric("p", "P", (row) =>
    row.probability < LEAST_SHOWN ? "< 1e-9" : significant(row.probability, 2),
  ),
];

const SCORES: Column<Score>[] = [
  {
    key: "mean",
    header: "Mean of the model",
    render: (row) => (row.uses_prediction ? "Prediction" : "None"),
  },
  numeric("degree", "Unpenalised degree", (row) => row.degree),
  numeric("density", "Log density of an estimate", (row) => fixed(row.log_density, 3)),
  numeric("rms", "rms / σ", (row) => fixed(row.rms, 2)),
  numeric("inside", "Within 2σ", (row) => percent(row.share_inside), "%"),
];

function nextCondition(model: GlobalModelSummary): string {
  const next = model.next_condition;
  const note = "σ of all derivatives relative to its smallest; extrapolation is blank";
  if (next === null) return note;
  const at = model.variables.map(({ quantity: key }, number) => {
    const { label, unit, factor } = quantity(key);
    return `${label.toLowerCase()} ${significant((next.condition[number] ?? 0) * factor, 3)} ${unit}`;
  });
  return `${note}. One more run at ${at.join(", ")} reduces the mean variance most, by ${percent(next.reduction, 1)} %`;
}

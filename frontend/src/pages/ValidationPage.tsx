import { MultiSelect, Select, Stack } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { useInfiniteQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useState } from "react";
import { crossPredictionResult, maneuversQuery, runListQuery } from "../api/queries";
import type { CrossPredictionMatrix } from "../api/types";
import { useStoredResult } from "../api/useStoredResult";
import { ButtonLink } from "../components/controls/ButtonLink";
import { CrossValidation } from "../components/comparison/CrossValidation";
import { ComputeButton } from "../components/controls/ComputeButton";
import { Empty } from "../components/display/Empty";
import { Figure } from "../components/figures/Figure";
import { JobWait } from "../components/jobs/JobWait";
import { Loaded } from "../components/display/Loaded";
import { NumberField } from "../components/controls/NumberField";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { Section } from "../components/display/Section";
import { fixed } from "../lib/format";
import { integer, integers, oneOf } from "../lib/urlState";
import { PARTITIONS, type ValidationView } from "../views";

const route = getRouteApi("/validation");

const HELD_OUT: Record<(typeof PARTITIONS)[number], string> = {
  folds: "Every fold of the frequencies",
  frequencies: "First fold of the frequencies",
  periods: "Last periods",
};
const FOLDS = 5;
/** Choices of one search. */
const MOST_OFFERED = 50;

interface ViewProps {
  view: ValidationView;
  onChange: (change: Partial<ValidationView>) => void;
}

/** Validation of runs: other maneuvers predicted, held-out data, and residual correlation. */
export function ValidationPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const runs = view.runs ?? [];
  const query = { run_ids: runs.join(","), maneuver_ids: view.maneuvers?.join(",") };
  const { result, jobId, error, onEnd, compute } = useStoredResult(crossPredictionResult(query));
  const change = (part: Partial<ValidationView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });
  return (
    <>
      <PageHead
        title="Validation"
        trail={[
          <Link to="/compare" search={{ runs: view.runs }} className="link" key="compare">
            Compare
          </Link>,
        ]}
      />
      <div className="split">
        <Choices view={view} onChange={change} />
        {runs.length === 0 ? (
          <div className="panel">
            <Empty title="No runs selected">
              Select succeeded runs, and maneuvers that their models predict from the measured
              inputs.
            </Empty>
          </div>
        ) : (
          <Stack gap="md">
            <ComputeButton compute={compute} />
            {error !== null && <ProblemAlert error={error} />}
            {jobId !== undefined && <JobWait key={jobId} id={jobId} onEnd={onEnd} />}
            {compute === undefined && jobId === undefined && error === null && (
              <Loaded query={result} rows={6}>
                {(matrix) => (
                  <Predictions matrix={matrix} query={query} view={view} onChange={change} />
                )}
              </Loaded>
            )}
          </Stack>
        )}
      </div>
    </>
  );
}

interface Option {
  value: string;
  label: string;
}

/** Choices of a search, and those selected before, by number if the search does not have them. */
function withSelected(found: Option[], ids: number[] | undefined, noun: string): Option[] {
  const listed = new Set(found.map((one) => one.value));
  const others = (ids ?? []).map(String).filter((id) => !listed.has(id));
  return [...found, ...others.map((id) => ({ value: id, label: `${noun} ${id}` }))];
}

function Choices({ view, onChange }: ViewProps) {
  const [typedRun, setTypedRun] = useState("");
  const [typedManeuver, setTypedManeuver] = useState("");
  const [searchRun] = useDebouncedValue(typedRun, 300);
  const [searchManeuver] = useDebouncedValue(typedManeuver, 300);
  const runs = useInfiniteQuery(
    runListQuery({ state: "succeeded", search: searchRun || undefined }, "-id", MOST_OFFERED),
  );
  const maneuvers = useInfiniteQuery(
    maneuversQuery({ search: searchManeuver || undefined }, "label", MOST_OFFERED),
  );
  return (
    <Stack gap="md">
      <MultiSelect
        label="Runs"
        description="Their models predict the maneuvers"
        searchable
        searchValue={typedRun}
        onSearchChange={setTypedRun}
        nothingFoundMessage="No succeeded run"
        clearable
        hidePickedOptions
        maxDropdownHeight={320}
        data-testid="validation-runs"
        data={withSelected(
          (runs.data?.pages ?? [])
            .flatMap((page) => page.items)
            .map((run) => ({
              value: String(run.id),
              label: `${run.method} ${String(run.id)}: ${run.modes.join(" ")}, ${run.maneuver_label}`,
            })),
          view.runs,
          "Run",
        )}
        value={(view.runs ?? []).map(String)}
        onChange={(ids) => {
          onChange({ runs: integers(ids), run: undefined, maneuver: undefined });
        }}
      />
      <MultiSelect
        label="Maneuvers"
        description="Default: those of the runs"
        searchable
        searchValue={typedManeuver}
        onSearchChange={setTypedManeuver}
        nothingFoundMessage="No maneuver"
        clearable
        hidePickedOptions
        maxDropdownHeight={320}
        data-testid="validation-maneuvers"
        data={withSelected(
          (maneuvers.data?.pages ?? [])
            .flatMap((page) => page.items)
            .map((one) => ({ value: String(one.id), label: one.label })),
          view.maneuvers,
          "Maneuver",
        )}
        value={(view.maneuvers ?? []).map(String)}
        onChange={(ids) => {
          onChange({ maneuvers: integers(ids), maneuver: undefined });
        }}
      />
      <Select
        label="Data held out"
        description="The selected run is fitted again without them"
        placeholder="None"
        clearable
        data-testid="validation-held-out"
        data={PARTITIONS.map((value) => ({ value, label: HELD_OUT[value] }))}
        value={view.partition ?? null}
        onChange={(value) => {
          onChange({ partition: oneOf(value, PARTITIONS) });
        }}
      />
      <NumberField
        label="Folds"
        description="Of periods, one share in so many is held out"
        placeholder={String(FOLDS)}
        min={2}
        max={20}
        allowDecimal={false}
        value={view.folds}
        onChange={(folds) => {
          onChange({ folds });
        }}
      />
    </Stack>
  );
}

interface PredictionsProps extends ViewProps {
  matrix: CrossPredictionMatrix;
  query: { run_ids: string; maneuver_ids?: string };
}

function Predictions({ matrix, query, view, onChange }: PredictionsProps) {
  const run = matrix.runs.find((one) => one.id === view.run) ?? matrix.runs[0];
  const own = matrix.predictions.filter((one) => one.run_id === run?.id);
  const cell = own.find((one) => one.maneuver_id === view.maneuver) ?? own[0];
  if (run === undefined || cell === undefined) return <Empty title="No predictions" />;
  const names = cell.outputs.map((one) => one.output);
  const output = names.find((name) => name === view.output) ?? names[0];
  const fit = cell.outputs.find((one) => one.output === output);
  const shown = { run_id: run.id, maneuver_id: cell.maneuver_id };
  return (
    <>
      <Section
        title="Cross-prediction"
        note="Mean R² of the outputs of each maneuver, predicted by each model from the measured inputs; click a cell to show it"
      >
        <Figure
          kind="cross-prediction"
          title="R² by model and maneuver"
          params={{ ...query }}
          onPick={(index) => {
            const picked = matrix.predictions[index];
            if (picked) onChange({ run: picked.run_id, maneuver: picked.maneuver_id });
          }}
        />
      </Section>
      <Section
        title="Prediction"
        note={
          fit
            ? `${fit.output}: R² ${fixed(fit.r_squared, 3)}, Theil ${fixed(fit.theil, 3)}${cell.is_fitted ? "; the run was fitted to this maneuver" : ""}`
            : (cell.error ?? "")
        }
        actions={
          <div style={{ display: "flex", gap: 8, flexWrap: "wrap", justifyContent: "flex-end" }}>
            <Select
              aria-label="Run"
              allowDeselect={false}
              w={200}
              data={matrix.runs.map((one) => ({ value: String(one.id), label: one.label }))}
              value={String(run.id)}
              onChange={(id) => {
                onChange({ run: integer(id ?? undefined) });
              }}
            />
            <Select
              aria-label="Maneuver"
              allowDeselect={false}
              w={200}
              data={matrix.maneuvers.map((one) => ({ value: String(one.id), label: one.label }))}
              value={String(cell.maneuver_id)}
              onChange={(id) => {
                onChange({ maneuver: integer(id ?? undefined) });
              }}
            />
            <Select
              aria-label="Output"
              searchable
              allowDeselect={false}
              w={140}
              data={names}
              value={output ?? null}
              onChange={(name) => {
                onChange({ output: name ?? undefined });
              }}
            />
            <ButtonLink
              variant="default"
              to="/runs/$id"
              params={{ id: run.id }}
              search={{ tab: "time", against: cell.maneuver_id }}
            >
              Time history
            </ButtonLink>
          </div>
        }
      >
        {output === undefined ? (
          <Empty title="Not predicted">{cell.error}</Empty>
        ) : (
          <Stack gap="md">
            <Figure
              kind="prediction"
              title={`${output}, measured and predicted`}
              params={{ ...shown, outputs: output }}
            />
            <Figure kind="prediction-residual" title="Residuals over frequency" params={shown} />
            <Figure
              kind="residual-correlation"
              title={`Correlation of the residual of ${output}`}
              params={{ ...shown, outputs: output }}
            />
          </Stack>
        )}
      </Section>
      {view.partition === undefined ? (
        <Section title="Cross-validation">
          <Empty title="No data held out">
            Select the data held out; the run is fitted again without them and predicts them.
          </Empty>
        </Section>
      ) : (
        <CrossValidation
          query={{ run_id: run.id, partition: view.partition, folds: view.folds }}
          output={output}
        />
      )}
    </>
  );
}

import { Group, MultiSelect, Select, Stack } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { useInfiniteQuery } from "@tanstack/react-query";
import { useState } from "react";
import { crossPredictionResult, maneuversQuery } from "../../api/queries";
import type { CrossPredictionMatrix } from "../../api/types";
import { useStoredResult } from "../../api/useStoredResult";
import { ButtonLink } from "../controls/ButtonLink";
import { CrossValidation } from "./CrossValidation";
import { ComputeButton } from "../controls/ComputeButton";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { JobWait } from "../jobs/JobWait";
import { Loaded } from "../display/Loaded";
import { NumberField } from "../controls/NumberField";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";
import { fixed } from "../../lib/text/format";
import { integer, integers, oneOf } from "../../lib/urlState";
import { PARTITIONS, type CompareView } from "../../views";
import type { CompareTabProps } from "./CompareDerivatives";

const HELD_OUT: Record<(typeof PARTITIONS)[number], string> = {
  folds: "Every fold of the frequencies",
  frequencies: "First fold of the frequencies",
  periods: "Last periods",
};
const FOLDS = 5;
/** Choices of one search. */
const MOST_OFFERED = 50;

interface ViewProps {
  view: CompareView;
  onChange: (change: Partial<CompareView>) => void;
}

/** Validation of the runs: other maneuvers predicted, held-out data, and residual correlation. */
export function CompareValidation({ view, onChange }: CompareTabProps) {
  const query = { run_ids: view.runs?.join(",") ?? "", maneuver_ids: view.maneuvers?.join(",") };
  const { result, jobId, error, onEnd, compute } = useStoredResult(crossPredictionResult(query));
  return (
    <Stack gap="md" miw={0}>
      <Choices view={view} onChange={onChange} />
      <ComputeButton compute={compute} />
      {error !== null && <ProblemAlert error={error} />}
      {jobId !== undefined && <JobWait key={jobId} id={jobId} onEnd={onEnd} />}
      {compute === undefined && jobId === undefined && error === null && (
        <Loaded query={result} rows={6}>
          {(matrix) => (
            <Predictions matrix={matrix} query={query} view={view} onChange={onChange} />
          )}
        </Loaded>
      )}
    </Stack>
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
  const [typed, setTyped] = useState("");
  const [search] = useDebouncedValue(typed, 300);
  const maneuvers = useInfiniteQuery(
    maneuversQuery({ search: search || undefined }, "label", MOST_OFFERED),
  );
  return (
    <Group gap="sm" align="flex-end">
      <MultiSelect
        label="Predicted maneuvers"
        placeholder={view.maneuvers === undefined ? "Those of the runs" : undefined}
        w={300}
        searchable
        searchValue={typed}
        onSearchChange={setTyped}
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
          onChange({ maneuvers: integers(ids), predicted: undefined });
        }}
      />
      <Select
        label="Data held out"
        placeholder="None"
        w={230}
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
        w={80}
        placeholder={String(FOLDS)}
        min={2}
        max={20}
        allowDecimal={false}
        value={view.folds}
        onChange={(folds) => {
          onChange({ folds });
        }}
      />
    </Group>
  );
}

interface PredictionsProps extends ViewProps {
  matrix: CrossPredictionMatrix;
  query: { run_ids: string; maneuver_ids?: string };
}

function Predictions({ matrix, query, view, onChange }: PredictionsProps) {
  const run = matrix.runs.find((one) => one.id === view.predicted_by) ?? matrix.runs[0];
  const own = matrix.predictions.filter((one) => one.run_id === run?.id);
  const cell = own.find((one) => one.maneuver_id === view.predicted) ?? own[0];
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
            if (picked) onChange({ predicted_by: picked.run_id, predicted: picked.maneuver_id });
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
                onChange({ predicted_by: integer(id ?? undefined) });
              }}
            />
            <Select
              aria-label="Maneuver"
              allowDeselect={false}
              w={200}
              data={matrix.maneuvers.map((one) => ({ value: String(one.id), label: one.label }))}
              value={String(cell.maneuver_id)}
              onChange={(id) => {
                onChange({ predicted: integer(id ?? undefined) });
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
              search={{ tab: "fit", against: cell.maneuver_id }}
              hash="time"
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

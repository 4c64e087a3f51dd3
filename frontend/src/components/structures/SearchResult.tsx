import { asAxis } from "../new-run/runRequest";
import { Alert, Badge, Button, Group, List, SegmentedControl, Text } from "@mantine/core";
import { useNavigate } from "@tanstack/react-router";
import { useAddStructure, useOpenCandidate } from "../../api/commands";
import {
  isOver,
  type SearchCandidate,
  type StructureSearch,
  type TermGroup,
} from "../../api/types";
import { fixed, percent, significant, withError } from "../../lib/text/format";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { Figure } from "../figures/Figure";
import { JobWait } from "../jobs/JobWait";
import { AdequacyBadge } from "../runs/ModelAdequacy";
import { ProblemAlert } from "../display/ProblemAlert";
import { UnitName, WithInterval } from "../display/Quantity";
import { Section } from "../display/Section";

interface Props {
  search: StructureSearch;
  group: string | undefined;
  onGroup: (group: string) => void;
}

/** Progress or result of a search. */
export function SearchResult({ search, group, onGroup }: Props) {
  const result = search.result;
  if (!isOver(search.state)) {
    return (
      <div className="panel" style={{ padding: 16 }}>
        {search.job_id !== null && <JobWait key={search.job_id} id={search.job_id} />}
      </div>
    );
  }
  if (result === null) {
    return (
      <Alert color="red.9" variant="filled" role="alert" title={`The search has ${search.state}`}>
        {search.error?.message ?? "No candidates."}
      </Alert>
    );
  }
  const isDecided = result.undecided === "";
  const shown = result.groups.find((one) => one.name === group) ?? result.groups[0];
  return (
    <>
      <Alert
        color={isDecided ? "blue" : "yellow"}
        variant="light"
        role="status"
        data-testid="search-sentence"
      >
        {result.sentence}
        {result.warnings.length > 0 && (
          <List size="sm" mt={6}>
            {result.warnings.map((warning) => (
              <List.Item key={warning}>{warning}</List.Item>
            ))}
          </List>
        )}
      </Alert>
      <Candidates search={search} result={result} />
      {result.groups.length > 1 && (
        <SegmentedControl
          data={result.groups.map((one) => one.name)}
          value={shown?.name ?? ""}
          onChange={onGroup}
          aria-label="Coefficient"
          style={{ alignSelf: "start" }}
        />
      )}
      {shown !== undefined && <Shown search={search} group={shown} />}
    </>
  );
}

interface CandidatesProps {
  search: StructureSearch;
  result: NonNullable<StructureSearch["result"]>;
}

function Candidates({ search, result }: CandidatesProps) {
  const navigate = useNavigate();
  const open = useOpenCandidate(search.id);
  const add = useAddStructure();
  const all = result.candidates;
  const least = Math.min(...all.map((one) => one.predictive_cost ?? Infinity));
  const makeStructure = (one: SearchCandidate) => {
    add.mutate(
      {
        aircraft_id: search.aircraft_id,
        name: `Search ${String(search.id)}: ${String(one.n_terms)} terms`,
        structure: { ...one.structure, axis: asAxis(one.structure.axis) },
        note: `${result.sentence} Candidate: ${one.why}`,
      },
      {
        onSuccess: (stored) =>
          void navigate({ to: "/model-structures/$id", params: { id: stored.id } }),
      },
    );
  };
  const columns: Column<{ one: SearchCandidate; index: number }>[] = [
    {
      key: "name",
      header: "Candidate",
      render: ({ one }) => (
        <div style={{ minWidth: 180, maxWidth: 340 }}>
          <Group gap={6}>
            <Text size="sm" fw={600}>
              {one.name}
            </Text>
            {one.proposed && <Badge size="sm">proposed</Badge>}
            {!one.converged && (
              <Badge size="sm" color="red.9">
                not converged
              </Badge>
            )}
          </Group>
          <Text size="xs" className="quiet" lineClamp={2} title={one.why}>
            {one.why}
          </Text>
        </div>
      ),
    },
    { key: "terms", header: "Terms", numeric: true, render: ({ one }) => one.n_terms },
    {
      key: "adequacy",
      header: "Model adequacy",
      render: ({ one }) => (
        <span title={one.adequacy_reason}>
          <AdequacyBadge state={one.adequacy} />
        </span>
      ),
    },
    {
      key: "predictive",
      header: "Predictive loss",
      unit: "−ln L",
      numeric: true,
      render: ({ one }) =>
        one.predictive_cost === null ? "–" : fixed(one.predictive_cost - least, 1),
    },
    { key: "bic", header: "BIC", numeric: true, render: ({ one }) => significant(one.bic, 7) },
    {
      key: "ratio",
      header: "Likelihood ratio (predicted)",
      numeric: true,
      render: ({ one }) =>
        one.likelihood_ratio === null
          ? "–"
          : `${fixed(one.likelihood_ratio, 1)} (${fixed(one.predicted_ratio, 1)})`,
    },
    {
      key: "flutter",
      header: "Flutter ±2σ",
      unit: <UnitName unit="m/s" />,
      numeric: true,
      render: ({ one }) => (
        <span title={one.flutter}>
          {one.flutter_m_s === null ? (
            "none"
          ) : (
            <WithInterval
              value={one.flutter_m_s}
              std={one.flutter_std_m_s ?? 0}
              unit="m/s"
              decimals={2}
            />
          )}
        </span>
      ),
    },
    {
      key: "actions",
      header: "",
      render: ({ one, index }) => (
        <Group gap={6} wrap="nowrap">
          <Button
            size="compact-xs"
            variant="default"
            data-testid={`open-candidate-${String(index)}`}
            loading={open.isPending && open.variables === index}
            onClick={() => {
              open.mutate(index, {
                onSuccess: (run) => void navigate({ to: "/runs/$id", params: { id: run.id } }),
              });
            }}
          >
            Open as run
          </Button>
          {result.undecided === "" && (
            <Button
              size="compact-xs"
              variant="default"
              data-testid={`create-structure-${String(index)}`}
              loading={add.isPending}
              onClick={() => {
                makeStructure(one);
              }}
            >
              Create model structure
            </Button>
          )}
        </Group>
      ),
    },
  ];
  return (
    <Section title="Candidates" note="Ordered by likelihood at validation frequencies">
      <DataTable
        label="Candidates"
        testId="candidates"
        columns={columns}
        rows={all.map((one, index) => ({ one, index }))}
        rowKey={(row) => row.index}
        isSelected={(row) => row.one.proposed}
      />
      {(open.isError || add.isError) && <ProblemAlert error={open.error ?? add.error} />}
    </Section>
  );
}

function Shown({ search, group }: { search: StructureSearch; group: TermGroup }) {
  const params = { search_id: search.id, group: group.name };
  return (
    <>
      <div className="halves">
        <div className="panel" style={{ padding: 12 }}>
          <Figure kind="search-path" title={`Path of ${group.name}`} params={params} height={560} />
        </div>
        <div className="panel" style={{ padding: 12 }}>
          <Figure
            kind="search-stability"
            title={`Stability of ${group.name}`}
            params={params}
            height={560}
          />
        </div>
      </div>
      <Section
        title={`Terms of ${group.name}`}
        note={`R² ${fixed(group.r_squared, 4)}, predicted squared error ${significant(group.pse, 4)} noise variances, BIC ${significant(group.bic, 7)}. An unselected term shows its value if entered next.`}
      >
        <DataTable
          label={`Terms of ${group.name}`}
          testId="terms"
          columns={TERM_COLUMNS}
          rows={group.terms}
          rowKey={(term) => term.name}
          isSelected={(term) => term.selected}
          maxHeight={520}
        />
      </Section>
      <Section
        title="Selection path"
        note={`F to enter ${fixed(search.settings.f_in, 1)}, to stay ${fixed(search.settings.f_out, 1)}`}
      >
        <DataTable
          label="Path"
          testId="path"
          columns={STEP_COLUMNS}
          rows={group.path.map((step, index) => ({ ...step, index: index + 1 }))}
          rowKey={(step) => step.index}
          maxHeight={420}
        />
      </Section>
      {group.dependencies.length > 0 && (
        <Section
          title="Nearly dependent terms"
          note="Condition index and variance proportions of each near dependency; strong from 30"
        >
          <DataTable
            label="Nearly dependent terms"
            columns={DEPENDENCY_COLUMNS}
            rows={group.dependencies.map((one, index) => ({ ...one, index }))}
            rowKey={(row) => row.index}
            maxHeight={320}
          />
        </Section>
      )}
    </>
  );
}

const TERM_COLUMNS: Column<TermGroup["terms"][number]>[] = [
  { key: "name", header: "Term", render: (term) => <DerivativeName name={term.name} /> },
  { key: "selected", header: "Selected", render: (term) => (term.selected ? "yes" : "no") },
  {
    key: "value",
    header: "Value",
    numeric: true,
    render: (term) => (term.value === null ? "–" : withError(term.value, term.std_error).value),
  },
  {
    key: "error",
    header: "σ",
    numeric: true,
    render: (term) => (term.value === null ? "–" : withError(term.value, term.std_error).error),
  },
  { key: "f", header: "Partial F", numeric: true, render: (term) => significant(term.f, 3) },
  numeric("stability", "In resamplings", (term) => percent(term.stability), "%"),
  numeric("support", "In maneuvers", (term) => percent(term.support), "%"),
  {
    key: "inflation",
    header: "Variance inflation",
    numeric: true,
    render: (term) => (term.inflation === null ? "∞" : significant(term.inflation, 3)),
  },
];

const STEP_COLUMNS: Column<TermGroup["path"][number] & { index: number }>[] = [
  { key: "index", header: "Step", numeric: true, render: (step) => step.index },
  { key: "action", header: "", render: (step) => (step.action === "enter" ? "in" : "out") },
  { key: "term", header: "Term", render: (step) => <DerivativeName name={step.term} /> },
  { key: "f", header: "Partial F", numeric: true, render: (step) => significant(step.f, 4) },
  { key: "n", header: "Terms", numeric: true, render: (step) => step.n_terms },
  { key: "r2", header: "R²", numeric: true, render: (step) => fixed(step.r_squared, 5) },
  { key: "pse", header: "PSE", numeric: true, render: (step) => significant(step.pse, 5) },
  { key: "bic", header: "BIC", numeric: true, render: (step) => significant(step.bic, 7) },
];

const DEPENDENCY_COLUMNS: Column<TermGroup["dependencies"][number] & { index: number }>[] = [
  numeric("index", "Condition index", (row) => fixed(row.condition_index, 1)),
  {
    key: "terms",
    header: "Terms and their shares",
    render: (row) => (
      <Group gap="md">
        {Object.entries(row.shares).map(([name, share]) => (
          <span key={name}>
            <DerivativeName name={name} /> {percent(share)} %
          </span>
        ))}
      </Group>
    ),
  },
];

import { Button, Select, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { address } from "../api/client";
import {
  globalModelDifferencesQuery,
  globalModelVersionQuery,
  globalModelVersionsQuery,
} from "../api/queries";
import type { GlobalModelDetail, VersionDifferences } from "../api/types";
import { ButtonLink } from "../components/controls/ButtonLink";
import { Facts } from "../components/display/ConditionFacts";
import { DataTable, numeric, type Column } from "../components/controls/DataTable";
import { DecisionBadge } from "../components/decisions/DecisionBadge";
import { DerivativeName } from "../components/display/DerivativeName";
import { Empty } from "../components/display/Empty";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { ReportMenu } from "../components/controls/ReportMenu";
import { Section } from "../components/display/Section";
import { dateTime, withError } from "../lib/text/format";
import { QUANTITIES } from "../lib/limits";
import { integer } from "../lib/urlState";

const route = getRouteApi("/global-model/$id");

type Change = VersionDifferences["derivatives"][number];

/** One version of a global model, its review, and what changed since another version. */
export function GlobalModelVersionPage() {
  const { id } = route.useParams();
  const version = useQuery(globalModelVersionQuery(id));
  return (
    <Loaded query={version} page={`Global model ${id}`}>
      {(data) => <Version key={id} version={data} />}
    </Loaded>
  );
}

function Version({ version }: { version: GlobalModelDetail }) {
  const outlying = version.runs.filter((run) => run.is_outlying).map((run) => run.run_id);
  return (
    <>
      <PageHead
        title={`Global model version ${version.version}: ${version.label}`}
        trail={[
          <Link to="/global-model" className="link" key="global-model">
            Global model
          </Link>,
        ]}
        aside={version.state !== null && <DecisionBadge state={version.state} />}
        actions={
          <>
            <Button
              component="a"
              variant="default"
              href={address(`global-models/versions/${version.id}/fmu`)}
              download
            >
              Download FMU
            </Button>
            <ReportMenu of={`global-model/${version.id}`} />
            <ButtonLink
              variant="default"
              to="/global-model"
              search={{
                runs: version.runs.map((run) => run.run_id),
                variables: version.variables,
                prediction: version.prediction_id ?? undefined,
              }}
            >
              Show surfaces
            </ButtonLink>
            {version.decision_id === null ? (
              <ButtonLink
                to="/decisions/new"
                search={{ global_model: version.id }}
                data-testid="propose-global-model"
              >
                Propose for approval
              </ButtonLink>
            ) : (
              <ButtonLink
                to="/decisions/$id"
                params={{ id: version.decision_id }}
                search={{}}
                variant="default"
              >
                Decision
              </ButtonLink>
            )}
          </>
        }
      />
      <div className="stack">
        <Section title="Version">
          <Facts
            facts={[
              ["Axis", version.axis],
              ["Variables", version.variables.map(quantityLabel).join(", ")],
              ["Runs", version.runs.map((run) => run.run_id).join(", ")],
              ["Outlying runs, excluded", outlying.join(", ") || "none"],
              ["By", version.author || "–"],
              ["Stored", dateTime(version.created_at)],
              ["SHA-256", version.result],
            ]}
          />
          <Text size="sm" mt="sm" data-testid="version-sentence">
            {version.sentence}
          </Text>
          {version.note !== "" && (
            <Text size="sm" mt="xs" style={{ whiteSpace: "pre-wrap" }}>
              {version.note}
            </Text>
          )}
        </Section>
        <Differences version={version} />
      </div>
    </>
  );
}

function Differences({ version }: { version: GlobalModelDetail }) {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const versions = useQuery(globalModelVersionsQuery(version.aircraft_id));
  const others = (versions.data ?? []).filter(
    (one) => one.axis === version.axis && one.id !== version.id,
  );
  const base = view.base ?? others.find((one) => one.version < version.version)?.id;
  return (
    <Section
      title="Changes"
      note="Derivatives ± σ at the mean condition of this version's runs"
      actions={
        others.length > 0 && (
          <Select
            aria-label="Compare with version"
            allowDeselect={false}
            data={others.map((one) => ({
              value: String(one.id),
              label: `version ${one.version}: ${one.label}`,
            }))}
            value={base === undefined ? null : String(base)}
            onChange={(id) => void navigate({ search: { base: integer(id) }, replace: true })}
          />
        )
      }
    >
      {base === undefined ? (
        <Empty title="No earlier version">Later versions show here what they change.</Empty>
      ) : (
        <Changes id={version.id} base={base} />
      )}
    </Section>
  );
}

function Changes({ id, base }: { id: number; base: number }) {
  const found = useQuery(globalModelDifferencesQuery(id, base));
  return (
    <Loaded query={found} rows={6}>
      {(data) => (
        <>
          <Facts
            facts={[
              ["Added runs", list(data.added_run_ids)],
              ["Removed runs", list(data.removed_run_ids)],
              ["Runs with another result", list(data.changed_run_ids)],
              ["Outlying before", list(data.outlying_before)],
              ["Outlying now", list(data.outlying_after)],
              ["Variables before", data.variables_before.map(quantityLabel).join(", ")],
            ]}
          />
          <DataTable
            label="Changes of derivatives"
            testId="version-changes"
            columns={COLUMNS}
            rows={data.derivatives}
            rowKey={(row) => row.name}
            maxHeight={480}
          />
        </>
      )}
    </Loaded>
  );
}

const COLUMNS: Column<Change>[] = [
  { key: "name", header: "Derivative", render: (row) => <DerivativeName name={row.name} /> },
  numeric("before", "Before ± σ", (row) => shown(row.before, row.before_std)),
  numeric("after", "Now ± σ", (row) => shown(row.after, row.after_std)),
  numeric("change", "Change / σ now", (row) =>
    row.before === null || row.after === null || !row.after_std
      ? "–"
      : ((row.after - row.before) / row.after_std).toFixed(1),
  ),
];

function shown(value: number | null, std: number | null): string {
  if (value === null) return "–";
  const text = withError(value, std);
  return `${text.value} ± ${text.error}`;
}

function list(ids: readonly number[]): string {
  return ids.join(", ") || "none";
}

function quantityLabel(key: string): string {
  return QUANTITIES.find((one) => one.key === key)?.label ?? key;
}

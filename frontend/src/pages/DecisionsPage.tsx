import { Group, Select } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { aircraftQuery, baselinesQuery, decisionsQuery } from "../api/queries";
import { DECISION_STATES, type Baseline, type DecisionItem } from "../api/types";
import { AuditTrailMenu } from "../components/account/AuditTrailMenu";
import { ButtonLink } from "../components/controls/ButtonLink";
import { DataTable, numeric, type Column } from "../components/controls/DataTable";
import { DecisionBadge } from "../components/decisions/DecisionBadge";
import { Empty } from "../components/display/Empty";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { ReviewRules } from "../components/decisions/ReviewRules";
import { Section } from "../components/display/Section";
import { StructureLink } from "../components/structures/StructureLink";
import { dateTime } from "../lib/text/format";
import { limitsText } from "../lib/limits";
import { integer } from "../lib/urlState";

const route = getRouteApi("/decisions");

/** Decisions, baselines and review rules. */
export function DecisionsPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const aircraft = useQuery(aircraftQuery);
  const craft = view.aircraft ?? aircraft.data?.[0]?.id;
  const decisions = useQuery({
    ...decisionsQuery({ aircraft_id: craft, state: view.state }),
    enabled: craft !== undefined,
  });
  return (
    <>
      <PageHead
        title="Decisions"
        trail={[
          <Link to="/campaign" className="link" key="campaign">
            Campaign
          </Link>,
        ]}
        actions={
          <>
            {craft !== undefined && (
              <AuditTrailMenu path="decisions/audit" query={{ aircraft_id: craft }} />
            )}
            <ButtonLink to="/decisions/new" search={{}} data-testid="propose">
              Propose model structure
            </ButtonLink>
          </>
        }
      />
      <Group mb="sm" gap="sm">
        {(aircraft.data?.length ?? 0) > 1 && (
          <Select
            aria-label="Aircraft"
            allowDeselect={false}
            data={aircraft.data?.map((one) => ({ value: String(one.id), label: one.name }))}
            value={craft === undefined ? null : String(craft)}
            onChange={(id) =>
              void navigate({ search: (before) => ({ ...before, aircraft: integer(id) }) })
            }
          />
        )}
        <Select
          aria-label="State"
          placeholder="Any state"
          clearable
          data={DECISION_STATES.map((one) => ({ value: one, label: one.replace("-", " ") }))}
          value={view.state ?? null}
          onChange={(state) =>
            void navigate({
              search: (before) => ({
                ...before,
                state: DECISION_STATES.find((one) => one === state),
              }),
            })
          }
        />
      </Group>
      <div className="stack">
        <div className="panel">
          <Loaded query={decisions} rows={6}>
            {(items) => <Listed items={items} />}
          </Loaded>
        </div>
        {craft !== undefined && (
          <div className="halves">
            <Section
              title="Baselines"
              note="Defaults of new runs; where ranges overlap, the latest approval applies."
            >
              <Baselines aircraftId={craft} />
            </Section>
            <Section title="Rules" note="Applied to every vote.">
              <ReviewRules aircraftId={craft} />
            </Section>
          </div>
        )}
      </div>
    </>
  );
}

function Listed({ items }: { items: DecisionItem[] }) {
  if (items.length === 0) {
    return (
      <Empty title="No decisions yet">
        A decision proposes a model structure for a range of conditions, or a global model. Once
        approved, it is the default of new runs there, or of flutter and closed loop.
      </Empty>
    );
  }
  const columns: Column<DecisionItem>[] = [
    {
      key: "title",
      header: "Decision",
      render: (one) => (
        <Link to="/decisions/$id" params={{ id: one.id }} className="link">
          {one.proposal.title}
        </Link>
      ),
    },
    { key: "state", header: "State", render: (one) => <DecisionBadge state={one.state} /> },
    {
      key: "model",
      header: "Model",
      render: ({ proposal, model_name }) =>
        proposal.structure === null ? (
          <Link
            to="/global-model/$id"
            params={{ id: proposal.global_model_id ?? 0 }}
            className="link"
          >
            {model_name}
          </Link>
        ) : (
          <StructureLink
            name={model_name}
            id={proposal.structure.id}
            version={proposal.structure.version}
          />
        ),
    },
    {
      key: "range",
      header: "For",
      wraps: true,
      render: ({ proposal }) =>
        proposal.structure === null ? "envelope of its runs" : limitsText(proposal.limits),
    },
    { key: "by", header: "By", render: (one) => one.authors.join(", ") },
    {
      key: "votes",
      header: "Votes",
      wraps: true,
      render: (one) =>
        Object.entries(one.votes)
          .map(([name, vote]) => `${name}: ${vote.replace("-", " ")}`)
          .join(", ") || "–",
    },
    numeric("at", "Last event", (one) => dateTime(one.changed_at ?? one.created_at)),
  ];
  return (
    <DataTable
      label="Decisions"
      testId="decisions-table"
      columns={columns}
      rows={items}
      rowKey={(one) => one.id}
    />
  );
}

function Baselines({ aircraftId }: { aircraftId: number }) {
  const baselines = useQuery(baselinesQuery(aircraftId));
  const columns: Column<Baseline>[] = [
    { key: "range", header: "For", wraps: true, render: (one) => limitsText(one.limits) },
    {
      key: "structure",
      header: "Structure",
      render: ({ structure }) => (
        <StructureLink
          name={structure.name}
          id={structure.structure_id}
          version={structure.version}
        />
      ),
    },
    {
      key: "decision",
      header: "Decision",
      render: (one) => (
        <Link to="/decisions/$id" params={{ id: one.decision_id }} className="link">
          {one.title}
        </Link>
      ),
    },
  ];
  return (
    <Loaded query={baselines} rows={2}>
      {(items) =>
        items.length === 0 ? (
          <Empty title="No baselines yet" />
        ) : (
          <DataTable
            label="Baselines"
            testId="baselines-table"
            columns={columns}
            rows={items}
            rowKey={(one) => one.decision_id}
          />
        )
      }
    </Loaded>
  );
}

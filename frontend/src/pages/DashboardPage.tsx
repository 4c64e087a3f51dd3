import { Group, SegmentedControl, Select, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { aircraftQuery, dashboardQuery } from "../api/queries";
import type { Dashboard, OpenWarnings } from "../api/types";
import { ButtonLink } from "../components/controls/ButtonLink";
import { DataTable, numeric, type Column } from "../components/controls/DataTable";
import { DerivativeName } from "../components/display/DerivativeName";
import { Empty } from "../components/display/Empty";
import { Figure, usePrefetchedFigure } from "../components/figures/Figure";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { quantity } from "../components/display/Quantity";
import { Section } from "../components/display/Section";
import { coefficientsIn } from "../lib/derivatives";
import { count, percent } from "../lib/format";
import { integer } from "../lib/urlState";

const route = getRouteApi("/dashboard");

const COVERAGE = "derivative-coverage";

type Cell = Dashboard["cells"][number];
type Derivative = Dashboard["derivatives"][number];

/** What is identified where in the envelope of a campaign, and what is left to do. */
export function DashboardPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const aircraft = useQuery(aircraftQuery);
  const id = view.aircraft ?? aircraft.data?.[0]?.id;
  const dashboard = useQuery({ ...dashboardQuery(id ?? 0), enabled: id !== undefined });
  const { coefficient } = view;
  usePrefetchedFigure(COVERAGE, id === undefined ? null : { aircraft_id: id, coefficient });
  return (
    <>
      <PageHead
        title="Dashboard"
        actions={
          (aircraft.data?.length ?? 0) > 1 && (
            <Select
              aria-label="Aircraft"
              w={220}
              data={aircraft.data?.map((one) => ({ value: String(one.id), label: one.name }))}
              value={id === undefined ? null : String(id)}
              allowDeselect={false}
              onChange={(next) =>
                void navigate({ search: (before) => ({ ...before, aircraft: integer(next) }) })
              }
            />
          )
        }
      />
      {aircraft.data?.length === 0 ? (
        <Nothing />
      ) : (
        <Loaded query={dashboard} rows={12}>
          {(data) => (data.n_maneuvers === 0 ? <Nothing /> : <Overview dashboard={data} />)}
        </Loaded>
      )}
    </>
  );
}

function Nothing() {
  return (
    <Empty title="No maneuvers yet">
      <ButtonLink to="/import">Import a maneuver</ButtonLink>
    </Empty>
  );
}

function Overview({ dashboard }: { dashboard: Dashboard }) {
  const { coefficient } = route.useSearch();
  const navigate = route.useNavigate();
  const coefficients = coefficientsIn(dashboard.derivatives.map((one) => one.name));
  return (
    <Stack gap="md">
      <div className="panel" style={{ padding: 12 }}>
        {coefficients.length > 1 && (
          <Group mb="xs" className="no-print">
            <SegmentedControl
              aria-label="Coefficient"
              data={[...coefficients, { value: "all", label: "All" }]}
              value={coefficient ?? "all"}
              onChange={(next) =>
                void navigate({
                  search: (before) => ({
                    ...before,
                    coefficient: next === "all" ? undefined : next,
                  }),
                })
              }
            />
          </Group>
        )}
        <Figure
          kind={COVERAGE}
          title={`Derivatives of ${dashboard.aircraft_name} over the envelope`}
          params={{ aircraft_id: dashboard.aircraft_id, coefficient }}
          onPick={(run) => void navigate({ to: "/runs/$id", params: { id: run }, search: {} })}
        />
      </div>
      <div className="two">
        <div className="stack">
          {dashboard.warnings.map((one) => (
            <Warnings key={one.kind} warnings={one} />
          ))}
        </div>
        <div className="stack">
          <Flown dashboard={dashboard} />
          <Identified dashboard={dashboard} />
        </div>
      </div>
    </Stack>
  );
}

function Flown({ dashboard }: { dashboard: Dashboard }) {
  const columns: Column<Cell>[] = [
    quantity("airspeed", "True airspeed", (one) => one.airspeed_m_s, "m/s", 1),
    numeric("fuel", "Fuel", (one) => percent(one.fuel_fraction), "%"),
    numeric("maneuvers", "Maneuvers", (one) => one.n_maneuvers),
    ...Object.keys(dashboard.n_runs).map((method) =>
      numeric<Cell>(method, `${method} runs`, (one) => one.n_runs[method] ?? 0),
    ),
  ];
  const runs = Object.entries(dashboard.n_runs).map(([method, n]) => `${n} ${method}`);
  return (
    <Section
      title="Maneuvers and runs over the envelope"
      note={`${count(dashboard.n_maneuvers, "maneuver")}; runs: ${runs.join(", ") || "none"}`}
    >
      <DataTable
        label="Maneuvers and runs over the envelope"
        testId="dashboard-cells"
        columns={columns}
        rows={dashboard.cells}
        rowKey={(one) => `${one.airspeed_m_s} ${one.fuel_fraction}`}
        maxHeight={420}
      />
    </Section>
  );
}

function Identified({ dashboard }: { dashboard: Dashboard }) {
  const columns: Column<Derivative>[] = [
    {
      key: "name",
      header: "Derivative",
      render: (one) => <DerivativeName name={one.name} />,
    },
    numeric("estimated", "Estimated", (one) => one.n_estimated),
    numeric("accurate", "σ\u00a0≤\u00a020\u00a0%", (one) => one.n_accurate),
    numeric("suspect", "Suspect", (one) => one.n_suspect),
    numeric("insensitive", "Insensitive", (one) => one.n_insensitive),
    numeric("smallest", "Smallest σ", (one) => percent(one.best?.relative_error, 1), "%"),
    {
      key: "run",
      header: "Run",
      render: (one) =>
        one.best && (
          <Link to="/runs/$id" params={{ id: one.best.run_id }} className="link">
            {one.best.run_id}
          </Link>
        ),
    },
  ];
  return (
    <Section
      title="Identified derivatives"
      note={`Number of conditions, of ${dashboard.cells.length} flown; σ relative to the estimate`}
    >
      {dashboard.derivatives.length === 0 ? (
        <Empty title="No derivative is estimated" />
      ) : (
        <DataTable
          label="Identified derivatives"
          testId="dashboard-derivatives"
          columns={columns}
          rows={dashboard.derivatives}
          rowKey={(one) => one.name}
          maxHeight={420}
        />
      )}
    </Section>
  );
}

const WARNINGS: Record<
  OpenWarnings["kind"],
  {
    title: string;
    none: string;
    one: (id: number, title: string) => React.ReactNode;
    all: React.ReactNode;
  }
> = {
  "suspect-runs": {
    title: "Suspect runs",
    none: "No run is suspect.",
    one: (id, title) => (
      <Link to="/runs/$id" params={{ id }} className="link">
        {title}
      </Link>
    ),
    all: (
      <Link to="/runs" search={{ adequacy: "suspect" }} className="link">
        All suspect runs
      </Link>
    ),
  },
  "failed-jobs": {
    title: "Failed jobs",
    none: "No job has failed.",
    one: (id, title) => (
      <Link to="/jobs/$id" params={{ id }} className="link">
        {title}
      </Link>
    ),
    all: (
      <Link to="/jobs" search={{ state: "failed" }} className="link">
        All failed jobs
      </Link>
    ),
  },
  reviews: {
    title: "Undecided and rejected proposals",
    none: "No proposal is undecided or rejected.",
    one: (id, title) => (
      <Link to="/decisions/$id" params={{ id }} className="link">
        {title}
      </Link>
    ),
    all: (
      <Link to="/decisions" className="link">
        All decisions
      </Link>
    ),
  },
  "maneuvers-without-run": {
    title: "Maneuvers without a run",
    none: "Every maneuver has a run.",
    one: (id, title) => (
      <Link to="/maneuvers/$id" params={{ id }} className="link">
        {title}
      </Link>
    ),
    all: (
      <Link to="/campaign" search={{ sort: "n_runs" }} className="link">
        Maneuvers by number of runs
      </Link>
    ),
  },
};

/** The newest records with a warning of one kind, and the list of all. */
function Warnings({ warnings }: { warnings: OpenWarnings }) {
  const { title, none, one, all } = WARNINGS[warnings.kind];
  const isCut = warnings.total > warnings.items.length;
  return (
    <Section
      title={title}
      note={isCut ? `${warnings.total}; the newest ${warnings.items.length}` : warnings.total}
      actions={warnings.total > 0 && <Text size="sm">{all}</Text>}
    >
      {warnings.total === 0 ? (
        <Text size="sm" className="quiet">
          {none}
        </Text>
      ) : (
        <Stack
          component="ul"
          gap={6}
          className="lines"
          aria-label={title}
          data-testid={`warnings-${warnings.kind}`}
        >
          {warnings.items.map((item) => (
            <li key={item.id}>
              <span className="line-what">
                {one(item.id, item.title)}
                <span className="quiet">{item.text}</span>
              </span>
            </li>
          ))}
        </Stack>
      )}
    </Section>
  );
}

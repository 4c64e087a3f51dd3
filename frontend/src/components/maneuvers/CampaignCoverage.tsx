import { Group, SegmentedControl, Select, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link, useNavigate } from "@tanstack/react-router";
import type { ReactNode } from "react";
import { aircraftQuery, dashboardQuery } from "../../api/queries";
import type { Aircraft, Dashboard, OpenWarnings } from "../../api/types";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { Loaded } from "../display/Loaded";
import { quantity } from "../display/Quantity";
import { Section } from "../display/Section";
import { coefficientsIn } from "../../lib/derivatives";
import { count, percent } from "../../lib/text/format";
import { integer } from "../../lib/urlState";
import type { CampaignView } from "../../views";

const COVERAGE = "derivative-coverage";

type Cell = Dashboard["cells"][number];
type Derivative = Dashboard["derivatives"][number];

interface Props {
  view: CampaignView;
  onChange: (change: Partial<CampaignView>) => void;
}

/** What is identified where in the envelope of a campaign. */
export function CampaignCoverage({ view, onChange }: Props) {
  const navigate = useNavigate();
  const { coefficient } = view;
  return (
    <OfAircraft view={view}>
      {(dashboard, choices) => {
        const coefficients = coefficientsIn(dashboard.derivatives.map((one) => one.name));
        return (
          <div className="stack">
            <div className="panel" style={{ padding: 12 }}>
              <Group mb="xs" className="no-print">
                {choices.length > 1 && (
                  <Select
                    aria-label="Aircraft"
                    w={220}
                    data={choices.map((one) => ({ value: String(one.id), label: one.name }))}
                    value={String(dashboard.aircraft_id)}
                    allowDeselect={false}
                    onChange={(next) => {
                      onChange({ aircraft: integer(next) });
                    }}
                  />
                )}
                {coefficients.length > 1 && (
                  <SegmentedControl
                    aria-label="Coefficient"
                    data={[...coefficients, { value: "all", label: "All" }]}
                    value={coefficient ?? "all"}
                    onChange={(next) => {
                      onChange({ coefficient: next === "all" ? undefined : next });
                    }}
                  />
                )}
              </Group>
              <Figure
                kind={COVERAGE}
                title={`Derivatives of ${dashboard.aircraft_name} over the envelope`}
                params={{ aircraft_id: dashboard.aircraft_id, coefficient }}
                onPick={(run) => void navigate({ to: "/runs/$id", params: { id: run } })}
              />
            </div>
            <div className="two">
              <Identified dashboard={dashboard} />
              <Flown dashboard={dashboard} />
            </div>
          </div>
        );
      }}
    </OfAircraft>
  );
}

/** What is left to do in a campaign. */
export function CampaignWarnings({ view }: Pick<Props, "view">) {
  return (
    <OfAircraft view={view}>
      {(dashboard) => (
        <div className="halves">
          {dashboard.warnings.map((one) => (
            <Warnings key={one.kind} warnings={one} />
          ))}
        </div>
      )}
    </OfAircraft>
  );
}

interface OfAircraftProps {
  view: CampaignView;
  children: (dashboard: Dashboard, choices: Aircraft[]) => ReactNode;
}

/** Loads the campaign of the selected aircraft, by default the first; nothing without maneuvers. */
function OfAircraft({ view, children }: OfAircraftProps) {
  const aircraft = useQuery(aircraftQuery);
  const id = view.aircraft ?? aircraft.data?.[0]?.id;
  const dashboard = useQuery({ ...dashboardQuery(id ?? 0), enabled: id !== undefined });
  if (aircraft.data?.length === 0 || dashboard.data?.n_maneuvers === 0) return null;
  return (
    <Loaded query={dashboard} rows={6}>
      {(data) => children(data, aircraft.data ?? [])}
    </Loaded>
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
    one: (id: number, title: string) => ReactNode;
    all: ReactNode;
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

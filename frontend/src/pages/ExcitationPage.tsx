import { Button, Group, Select, Stack, Tabs } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { Link, useNavigate, useSearch } from "@tanstack/react-router";
import { useSearchDesign } from "../api/commands";
import { aircraftQuery, catalogueQuery, designsQuery, rowTargetsQuery } from "../api/queries";
import type { CatalogueRow, Design, DesignRequest, RowTargets } from "../api/types";
import { DataTable, type Column } from "../components/controls/DataTable";
import { Empty } from "../components/display/Empty";
import { ImportDesignForm } from "../components/designs/ImportDesignForm";
import { Loaded } from "../components/display/Loaded";
import { CustomDesignForm } from "../components/designs/CustomDesignForm";
import { NumberField } from "../components/controls/NumberField";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { Section } from "../components/display/Section";
import { JobWait } from "../components/jobs/JobWait";
import { bandOf } from "../lib/drafts/designDraft";
import { dateTime, fixed } from "../lib/text/format";
import { useDraft } from "../lib/drafts/useDraft";
import { DESIGN_SOURCES, type ExcitationView } from "../views";

const DEGREE = Math.PI / 180;
const FORMS = ["csv", "mat", "h", "json"] as const;
const NONE = "none";
const LEVELS = [0.5, 1, 2] as const;

const DESIGN_COLUMNS: Column<Design>[] = [
  {
    key: "name",
    header: "Design",
    render: (design) => (
      <Link to="/excitation/$id" params={{ id: design.id }} className="link">
        {design.name}
      </Link>
    ),
  },
  {
    key: "duration",
    header: "Duration",
    unit: "s",
    numeric: true,
    render: (design) => fixed(design.specification.duration_s, 1),
  },
  {
    key: "rate",
    header: "Rate",
    unit: "Hz",
    numeric: true,
    render: (design) => fixed(design.specification.rate_hz, 0),
  },
  { key: "band", header: "Band", unit: "Hz", numeric: true, render: bandOf },
  {
    key: "inputs",
    header: "Inputs",
    wraps: true,
    render: (design) => design.specification.inputs.map((own) => own.name).join(", "),
  },
  {
    key: "rpf",
    header: "Highest RPF",
    numeric: true,
    render: (design) => fixed(Math.max(...Object.values(design.peak_factors)), 3),
  },
  {
    key: "at",
    header: "Created",
    numeric: true,
    render: (design) => dateTime(design.created_at),
  },
  {
    key: "preflight",
    header: "Pre-flight",
    render: (design) => (
      <Link
        to="/excitation/$id"
        params={{ id: design.id }}
        search={{ tab: "preflight-simulation" }}
        className="link"
        aria-label={`Pre-flight simulation of ${design.name}`}
      >
        simulate
      </Link>
    ),
  },
  {
    key: "files",
    header: "Medium amplitude as",
    render: (design) => (
      <Group gap="xs" wrap="nowrap">
        {FORMS.map((form) => (
          <a
            key={form}
            className="link"
            href={`/api/v1/designs/${design.id}/export?form=${form}&level=1`}
            aria-label={`${design.name} as ${form}`}
          >
            {form}
          </a>
        ))}
      </Group>
    ),
  },
];

/** Multisine designs, and the catalogue of flight test aids to design from. */
export function ExcitationPage() {
  const view: ExcitationView = useSearch({ strict: false });
  const navigate = useNavigate({ from: "/excitation" });
  const designs = useQuery(designsQuery);
  const catalogue = useQuery(catalogueQuery);
  const aircraft = useQuery(aircraftQuery);
  const search = useSearchDesign();
  const cache = useQueryClient();
  const { draft, setDraft } = useDraft("catalogue-design", {
    period: 24,
    rate: 100,
    first: 6,
    peak: 2,
    throttle: 5,
    aircraft: "",
    airspeed: 0,
  });
  const { period, rate, first, peak, throttle } = draft;
  const airspeed = draft.airspeed > 0 ? draft.airspeed : undefined;
  const known = (aircraft.data ?? []).map((one) => ({ value: String(one.id), label: one.name }));
  // The first aircraft is the default; without an aircraft the band of the catalogue is used.
  const aircraftId = draft.aircraft === "" ? (known[0]?.value ?? NONE) : draft.aircraft;
  const targets = useQuery(
    rowTargetsQuery(
      aircraftId === NONE
        ? null
        : {
            aircraft_id: Number(aircraftId),
            airspeed_m_s: airspeed,
            period_s: period,
            first_harmonic: Math.round(first),
          },
    ),
  );
  const targetsOf = (row: CatalogueRow) =>
    aircraftId === NONE ? undefined : targets.data?.find((one) => one.number === row.number);
  const set = (key: "period" | "rate" | "first" | "peak" | "throttle") => (value: number) => {
    setDraft((previous) => ({ ...previous, [key]: value }));
  };

  const make = (request: DesignRequest) => {
    search.mutate(request);
  };
  const fromRow = (row: CatalogueRow): DesignRequest => ({
    name: `FTA ${row.number}`,
    fta: row.number,
    aircraft_id: aircraftId === NONE ? null : Number(aircraftId),
    airspeed_m_s: aircraftId === NONE ? null : (airspeed ?? null),
    fuel_fraction: 0.5,
    altitude_m: 0,
    duration_s: period * row.periods,
    rate_hz: rate,
    first_harmonic: first,
    throttle_peak: row.throttles === 0 ? null : throttle / 100,
    peaks: [LEVELS[0] * peak * DEGREE, LEVELS[1] * peak * DEGREE, LEVELS[2] * peak * DEGREE],
    inputs: [],
    bands: [],
    effort: "thorough",
    seed: 0,
    note: "",
  });
  const making = search.isPending ? search.variables.fta : null;

  const columns: Column<CatalogueRow>[] = [
    { key: "fta", header: "FTA", render: (row) => `${row.number}–${row.number + 2}` },
    {
      key: "make",
      header: "",
      render: (row) => (
        <Button
          variant="default"
          size="compact-xs"
          loading={making === row.number}
          disabled={search.isPending}
          aria-label={`Design FTA ${row.number}`}
          onClick={() => {
            make(fromRow(row));
          }}
        >
          Design
        </Button>
      ),
    },
    { key: "axis", header: "Surfaces", render: (row) => `${row.surfaces} ${row.axis}` },
    {
      key: "duration",
      header: "Duration, fuel",
      render: (row) => describeDuration(row, targetsOf(row)),
    },
    {
      key: "harmonics",
      header: "Harmonics per surface",
      numeric: true,
      render: (row) => targetsOf(row)?.harmonics_per_surface ?? row.harmonics_per_input,
    },
    {
      key: "throttles",
      header: "Throttles × harmonics",
      numeric: true,
      render: (row) => (row.throttles === 0 ? "" : `${row.throttles} × ${row.throttle_harmonics}`),
    },
    { key: "targets", header: "Modes", render: (row) => row.targets },
    {
      key: "band",
      header: "Band",
      unit: "Hz",
      numeric: true,
      render: (row) => {
        const found = targetsOf(row);
        return found === undefined ? "" : `${fixed(found.low_hz, 2)}–${fixed(found.high_hz, 2)}`;
      },
    },
    {
      key: "resolution",
      header: "Resolution",
      unit: "Hz",
      numeric: true,
      render: (row) => fixed(targetsOf(row)?.resolution_hz ?? null, 4),
    },
    {
      key: "reached",
      header: "Harmonics about targets",
      wraps: true,
      render: (row) => describeTargets(targetsOf(row)),
    },
    {
      key: "least",
      header: "Least duration",
      unit: "s",
      numeric: true,
      render: (row) => {
        const least = targetsOf(row)?.least_duration_s;
        return least === undefined || least === 0 ? "" : fixed(least, 0);
      },
    },
  ];

  return (
    <>
      <PageHead
        title="Excitation"
        trail={[
          <Link to="/campaign" className="link" key="campaign">
            Campaign
          </Link>,
        ]}
      />
      <Stack gap="md">
        {search.isError && <ProblemAlert error={search.error} />}
        {search.data !== undefined && (
          <JobWait
            key={search.data.id}
            id={search.data.id}
            onEnd={() => void cache.invalidateQueries({ queryKey: ["designs"], exact: true })}
          />
        )}
        <Section title="Designs" note="RPF includes peaks between samples; a single sine has RPF 1">
          <Loaded query={designs}>
            {(rows) =>
              rows.length === 0 ? (
                <Empty title="No designs yet">Create one below.</Empty>
              ) : (
                <DataTable
                  label="Designs"
                  testId="designs-table"
                  columns={DESIGN_COLUMNS}
                  rows={rows}
                  rowKey={(design) => design.id}
                />
              )
            }
          </Loaded>
        </Section>
        <Tabs
          value={view.from ?? "table"}
          onChange={(next) =>
            void navigate({ search: { from: DESIGN_SOURCES.find((one) => one === next) } })
          }
        >
          <Tabs.List aria-label="Design source">
            <Tabs.Tab value="table">FTA catalogue</Tabs.Tab>
            <Tabs.Tab value="own">Custom design</Tabs.Tab>
            <Tabs.Tab value="flown">Import flown multisine</Tabs.Tab>
          </Tabs.List>
          <Tabs.Panel value="table" pt="md">
            <Section
              title="FTA catalogue"
              note="Low and high amplitudes are half and twice the medium amplitude"
            >
              <Group mb="sm">
                <PositiveInput label="T" unit="s" value={period} onChange={set("period")} />
                <PositiveInput label="Rate [Hz]" value={rate} onChange={set("rate")} />
                <PositiveInput label="First harmonic" value={first} onChange={set("first")} />
                <Select
                  label="Target modes of"
                  w={220}
                  allowDeselect={false}
                  data={[...known, { value: NONE, label: "none: band of the catalogue" }]}
                  value={aircraftId}
                  onChange={(next) => {
                    if (next !== null) setDraft((previous) => ({ ...previous, aircraft: next }));
                  }}
                />
                <NumberField
                  label="Airspeed"
                  unit="m/s"
                  placeholder="in vacuo"
                  w={150}
                  min={0}
                  disabled={aircraftId === NONE}
                  value={airspeed}
                  onChange={(next) => {
                    setDraft((previous) => ({ ...previous, airspeed: next ?? 0 }));
                  }}
                />
                <PositiveInput
                  label="Body flap, medium"
                  unit="deg"
                  value={peak}
                  onChange={set("peak")}
                />
                <PositiveInput
                  label="Throttles, medium"
                  unit="%"
                  value={throttle}
                  onChange={set("throttle")}
                />
              </Group>
              {targets.isError && <ProblemAlert error={targets.error} />}
              <Loaded query={catalogue} rows={24}>
                {(rows) => (
                  <DataTable
                    label="FTA catalogue"
                    testId="catalogue-table"
                    columns={columns}
                    rows={rows}
                    rowKey={(row) => row.number}
                    isSelected={(row) => targetsOf(row)?.reaches_targets === false}
                  />
                )}
              </Loaded>
            </Section>
          </Tabs.Panel>
          <Tabs.Panel value="own" pt="md">
            <Section
              title="Custom design"
              note="Disjoint harmonics; inputs with the same band are interleaved in the order of the table"
            >
              <CustomDesignForm busy={search.isPending} onDesign={make} />
            </Section>
          </Tabs.Panel>
          <Tabs.Panel value="flown" pt="md">
            <Section
              title="Import flown multisine"
              note="One column per input; harmonics, amplitudes and phases are identified"
            >
              <ImportDesignForm />
            </Section>
          </Tabs.Panel>
        </Tabs>
      </Stack>
    </>
  );
}

/** Duration, and the fuel that burns meanwhile; beyond a limit one linear model does not hold. */
function describeDuration(row: CatalogueRow, found: RowTargets | undefined): string {
  const duration = row.periods === 1 ? "T" : "4T";
  if (found?.fuel_burnt == null) return duration;
  const most = fixed(100 * found.largest_fuel_burnt, 0);
  const excess = found.fuel_burnt > found.largest_fuel_burnt ? ` (more than ${most} %)` : "";
  return `${duration}, ${fixed(100 * found.fuel_burnt, 1)} %${excess}`;
}

/** Harmonics about each target; targets without a predicted frequency are named. */
function describeTargets(row: RowTargets | undefined): string {
  if (row === undefined) return "";
  const found = row.modes.map(
    (mode) =>
      `${mode.name} ${mode.in_band ? String(mode.harmonics_per_surface) : "outside the band"}`,
  );
  const missing = row.missing.map((group) => `${group} not predicted`);
  return [...found, ...missing].join(", ");
}

interface PositiveInputProps {
  label: string;
  unit?: string;
  value: number;
  onChange: (value: number) => void;
}

function PositiveInput({ onChange, ...field }: PositiveInputProps) {
  return (
    <NumberField
      {...field}
      isPositive
      w={170}
      onChange={(next) => {
        if (next !== undefined) onChange(next);
      }}
    />
  );
}

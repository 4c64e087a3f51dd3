import { Button, Group, Progress, Select, Stack, Text } from "@mantine/core";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useCallback } from "react";
import { useAssess } from "../api/commands";
import { flightsQuery, qualitiesQuery } from "../api/queries";
import type { QualityItem } from "../api/types";
import { DataTable, type Column } from "../components/controls/DataTable";
import { Empty } from "../components/display/Empty";
import { FacetSelect } from "../components/controls/FacetSelect";
import { FilterInput } from "../components/controls/FilterInput";
import { ListFoot } from "../components/controls/ListFoot";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { VerdictBadge } from "../components/display/VerdictBadge";
import { count, fixed, flightNumber, percent } from "../lib/format";
import { integer, oneOf } from "../lib/urlState";
import { VERDICTS, type QualityView } from "../views";

const route = getRouteApi("/quality");

const columns: Column<QualityItem>[] = [
  {
    key: "verdict",
    header: "Verdict",
    sort: "verdict",
    render: (one) => <VerdictBadge verdict={one.verdict} />,
  },
  {
    key: "label",
    header: "Maneuver",
    sort: "label",
    render: (one) => (
      <Link
        to="/maneuvers/$id"
        params={{ id: one.maneuver_id }}
        search={{ tab: "quality" }}
        className="link"
      >
        {one.label}
      </Link>
    ),
  },
  {
    key: "flight",
    header: "Flight",
    sort: "flight_number",
    numeric: true,
    render: (one) => flightNumber(one.flight_number),
  },
  {
    key: "ratio",
    header: (
      <>
        V/V<sub>f</sub>
      </>
    ),
    sort: "airspeed_ratio",
    numeric: true,
    render: (one) => fixed(one.airspeed_ratio, 3),
  },
  {
    key: "signal",
    onlyIf: (one) => one.figures?.signal_to_noise_db != null,
    header: <span title="Median of all outputs over all frequencies">Signal/noise</span>,
    unit: "dB",
    sort: "signal_to_noise_db",
    numeric: true,
    render: (one) => fixed(one.figures?.signal_to_noise_db, 0),
  },
  {
    key: "coherence",
    onlyIf: (one) => one.figures?.least_coherence != null,
    header: <span title="Lowest coherence of a sensor with the others">Coherence</span>,
    sort: "least_coherence",
    numeric: true,
    render: (one) => fixed(one.figures?.least_coherence, 2),
  },
  {
    key: "skew",
    onlyIf: (one) => one.figures?.largest_skew_s != null,
    header: "Largest skew",
    unit: "ms",
    sort: "largest_skew_s",
    numeric: true,
    render: (one) =>
      one.figures?.largest_skew_s == null
        ? "–"
        : `${fixed(1e3 * one.figures.largest_skew_s, 1)} ${one.figures.largest_skew_channel ?? ""}`,
  },
  {
    key: "spikes",
    onlyIf: (one) => one.figures?.n_stretches != null,
    header: <span title="Spikes, dropouts and saturated intervals">Spikes</span>,
    sort: "n_stretches",
    numeric: true,
    render: (one) => one.figures?.n_stretches ?? "–",
  },
  {
    key: "inputs",
    onlyIf: (one) => one.figures?.max_input_correlation != null,
    header: <span title="Largest pairwise correlation of the inputs">Input corr.</span>,
    sort: "max_input_correlation",
    numeric: true,
    render: (one) => fixed(one.figures?.max_input_correlation, 2),
  },
  {
    key: "drift",
    onlyIf: (one) => one.figures?.airspeed_drift != null,
    header: "Airspeed drift",
    unit: "%",
    sort: "airspeed_drift",
    numeric: true,
    render: (one) => percent(one.figures?.airspeed_drift, 1),
  },
  {
    key: "summary",
    onlyIf: (one) => one.summary != null,
    header: "Summary",
    wraps: true,
    render: (one) => (
      <span style={{ display: "block", maxWidth: 460, whiteSpace: "normal" }}>
        {one.summary ?? "–"}
      </span>
    ),
  },
];

/** Quality of all maneuvers of the campaign, the worst first. */
export function QualityPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const sort = view.sort ?? "verdict";
  const list = useInfiniteQuery(
    qualitiesQuery({ verdict: view.verdict, flight_id: view.flight, search: view.search }, sort),
  );
  const flights = useQuery(flightsQuery);
  const change = useCallback(
    (part: Partial<QualityView>) =>
      void navigate({ search: (previous) => ({ ...previous, ...part }) }),
    [navigate],
  );
  const head = list.data?.pages[0];
  const items = list.data?.pages.flatMap((page) => page.items) ?? [];
  return (
    <>
      <PageHead
        title="Quality"
        actions={head && <Assess missing={head.counts.missing ?? 0} assessing={head.assessing} />}
      />
      <Stack gap="sm">
        <Group gap="sm" align="flex-end">
          <FilterInput
            label="Search"
            placeholder="maneuver or warning"
            value={view.search ?? ""}
            onCommit={(text) => {
              change({ search: text || undefined });
            }}
          />
          <FacetSelect
            label="Verdict"
            width={150}
            testId="quality-verdict"
            choices={VERDICTS.map((name) => ({
              value: name,
              label: name,
              count: head?.counts[name] ?? 0,
            }))}
            value={view.verdict}
            onChange={(value) => {
              change({ verdict: oneOf(value, VERDICTS) });
            }}
          />
          <Select
            label="Flight"
            placeholder="any"
            w={100}
            clearable
            data={(flights.data ?? []).map((flight) => ({
              value: String(flight.id),
              label: String(flight.number),
            }))}
            value={view.flight === undefined ? null : String(view.flight)}
            onChange={(value) => {
              change({ flight: integer(value ?? undefined) });
            }}
          />
        </Group>
        <div className="panel">
          <Loaded query={list} rows={12}>
            {() =>
              items.length === 0 ? (
                <Empty title="No maneuvers">Widen or clear the filters, or import some.</Empty>
              ) : (
                <DataTable
                  label="Quality of maneuvers"
                  testId="quality-table"
                  columns={columns}
                  rows={items}
                  rowKey={(one) => one.maneuver_id}
                  rowTestId={(one) => `quality-row-${one.maneuver_id}`}
                  sort={sort}
                  onSort={(next) => {
                    change({ sort: next === "verdict" ? undefined : next });
                  }}
                />
              )
            }
          </Loaded>
        </div>
        <ListFoot
          counts={
            head === undefined
              ? ""
              : `${items.length} shown: ${VERDICTS.map((v) => `${head.counts[v] ?? 0} ${v}`).join(", ")}`
          }
          testId="quality-count"
          list={list}
        />
      </Stack>
    </>
  );
}

interface AssessProps {
  missing: number;
  assessing: { running: boolean; done: number; total: number; failed: number };
}

/** Quality check of new maneuvers; results are stored, so that each is computed once. */
function Assess({ missing, assessing }: AssessProps) {
  const assess = useAssess();
  if (assess.isError) return <ProblemAlert error={assess.error} />;
  if (assessing.running) {
    return (
      <Group gap="sm" data-testid="assessing">
        <Progress
          w={160}
          value={(100 * assessing.done) / Math.max(1, assessing.total)}
          aria-label="Checked maneuvers"
        />
        <Text size="sm" className="numbers">
          {assessing.done} of {assessing.total}
        </Text>
        <Button
          variant="default"
          loading={assess.isPending}
          onClick={() => {
            assess.mutate("stop");
          }}
        >
          Cancel
        </Button>
      </Group>
    );
  }
  return (
    <Button
      disabled={missing === 0}
      loading={assess.isPending}
      data-testid="assess"
      onClick={() => {
        assess.mutate("begin");
      }}
    >
      {missing === 0 ? "All checked" : `Check ${count(missing, "maneuver")}`}
    </Button>
  );
}

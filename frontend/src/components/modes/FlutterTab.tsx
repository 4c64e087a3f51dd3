import { Anchor, Select, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import {
  flutterSummariesQuery,
  predictedFlutterResult,
  predictionsQuery,
  summaryRootsQuery,
} from "../../api/queries";
import type { Aircraft, FlutterSummary, ModalTable, SummaryRoots } from "../../api/types";
import { useStoredResult } from "../../api/useStoredResult";
import { fixed } from "../../lib/text/format";
import type { ModalDataView } from "../../views";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { Loaded } from "../display/Loaded";
import { NumberField } from "../controls/NumberField";
import { StoredPredictedFlutter } from "../predictions/PredictedFlutter";
import { Section } from "../display/Section";
import { TableNotes } from "./TableNotes";

type Point = FlutterSummary["points"][number];

const KNOT = 1852 / 3600;

interface Props {
  aircraft: Aircraft;
  /** Modal table whose modes name the roots. */
  table: ModalTable | undefined;
  view: ModalDataView;
  onChange: (change: Partial<ModalDataView>) => void;
}

/** Flutter summaries of a structural program: V-g and V-f, instabilities, prediction beside. */
export function FlutterTab(props: Props) {
  const summaries = useQuery(flutterSummariesQuery(props.aircraft.id));
  return (
    <Loaded query={summaries} rows={8}>
      {(known) => {
        const summary = known.find((one) => one.id === props.view.summary) ?? known.at(-1);
        return summary === undefined ? (
          <div className="panel">
            <Empty title="No flutter summaries yet">
              Import a printout (.f06) of a Nastran flutter analysis (SOL 145).
            </Empty>
          </div>
        ) : (
          <OneSummary {...props} all={known} summary={summary} />
        );
      }}
    </Loaded>
  );
}

function OneSummary(props: Props & { all: FlutterSummary[]; summary: FlutterSummary }) {
  const { all, summary, table, view, onChange } = props;
  const analysis = Math.min(view.analysis ?? 0, Math.max(summary.analyses.length - 1, 0));
  const query = {
    analysis,
    g: view.g ?? 0,
    modal_table_id: table?.id,
    fuel: (view.fuel ?? 50) / 100,
  };
  const roots = useQuery(summaryRootsQuery(summary.id, query));
  const compared = roots.data?.compared;
  const beside =
    view.prediction === undefined || compared == null
      ? undefined
      : { prediction_id: view.prediction, fuel: query.fuel, ...compared };
  const predicted = useStoredResult(predictedFlutterResult(beside));
  const isDrawn = predicted.result.data !== undefined && beside !== undefined;
  return (
    <div className="split split-early">
      <Stack gap="md">
        <Select
          label="Flutter summary"
          allowDeselect={false}
          data-testid="flutter-summary"
          data={all.map((one) => ({ value: String(one.id), label: `${one.name}, ${one.origin}` }))}
          value={String(summary.id)}
          onChange={(value) => {
            onChange({ summary: Number(value), analysis: undefined });
          }}
        />
        {summary.analyses.length > 0 && (
          <Select
            label="Analysis"
            description="In printed order"
            allowDeselect={false}
            data-testid="flutter-analysis"
            data={summary.analyses.map((one, place) => ({
              value: String(place),
              label: one.title,
            }))}
            value={String(analysis)}
            onChange={(value) => {
              onChange({ analysis: Number(value) });
            }}
          />
        )}
        <NumberField
          label="Structural damping g"
          description="Flutter is where a root needs as much"
          min={0}
          max={1}
          step={0.01}
          decimalScale={4}
          data-testid="flutter-g"
          value={view.g ?? 0}
          onChange={(value) => {
            onChange({ g: value === 0 ? undefined : value });
          }}
        />
        <PredictionSelect {...props} isComparable={compared != null} />
      </Stack>
      <Stack gap="md">
        {beside !== undefined && <StoredPredictedFlutter stored={predicted} />}
        {summary.analyses.length > 0 && (
          <Loaded query={roots} rows={10}>
            {(data) => (
              <>
                <div className="panel" style={{ padding: 12 }}>
                  <Figure
                    kind="flutter-summary"
                    title={`V-g and V-f, ${data.analysis.title}`}
                    params={{
                      summary_id: summary.id,
                      ...query,
                      prediction_id: isDrawn ? view.prediction : undefined,
                    }}
                  />
                </div>
                <Instabilities roots={data} />
              </>
            )}
          </Loaded>
        )}
        <Overview
          summary={summary}
          onSelect={(place) => {
            onChange({ analysis: place });
          }}
        />
      </Stack>
    </div>
  );
}

function PredictionSelect({
  aircraft,
  view,
  onChange,
  isComparable,
}: Props & { isComparable: boolean }) {
  const predictions = useQuery(predictionsQuery(aircraft.id));
  return (
    <Select
      label="Prediction"
      description={
        isComparable
          ? "Its flutter at the same airspeeds and air density (ratio 1 is 1.225 kg/m³)"
          : "Not comparable: the analysis has no single air density"
      }
      clearable
      disabled={!isComparable}
      data-testid="summary-prediction"
      data={(predictions.data ?? [])
        .filter((one) => one.names.some((name) => name.startsWith("CQ")))
        .map((one) => ({ value: String(one.id), label: one.source }))}
      value={view.prediction === undefined ? null : String(view.prediction)}
      onChange={(id) => {
        onChange({ prediction: id === null ? undefined : Number(id) });
      }}
    />
  );
}

/** Where roots of one analysis become unstable. */
function Instabilities({ roots }: { roots: SummaryRoots }) {
  const names = new Map(roots.roots.map((root) => [root.number, root.name]));
  const columns: Column<Point>[] = [
    { key: "root", header: "Root", numeric: true, render: (row) => row.root },
    { key: "mode", header: "Mode", render: (row) => names.get(row.root) ?? "" },
    {
      key: "kind",
      header: "Instability",
      render: (row) => (row.is_bound ? `${row.kind}, unstable at or below` : row.kind),
    },
    numeric("speed", "Airspeed", (row) => fixed(row.airspeed_m_s, 2), "m/s"),
    numeric("knots", "Airspeed", (row) => fixed(row.airspeed_m_s / KNOT, 2), "kt"),
    numeric(
      "frequency",
      "Frequency",
      (row) => (row.kind === "divergence" ? "–" : fixed(row.omega_rad_s / 2 / Math.PI, 2)),
      "Hz",
    ),
    numeric("density", "Density ratio", (row) => fixed(row.density_ratio, 4)),
    numeric("mach", "Mach", (row) => fixed(row.mach, 2)),
  ];
  return (
    <Section title="Instabilities" note={`At structural damping g = ${fixed(roots.g, 3)}`}>
      {roots.points.length === 0 ? (
        <Text size="sm">No root of this analysis becomes unstable.</Text>
      ) : (
        <DataTable
          label="Instabilities"
          testId="instabilities"
          columns={columns}
          rows={roots.points}
          rowKey={(row) => `${String(row.root)} ${String(row.airspeed_m_s)}`}
        />
      )}
    </Section>
  );
}

/** All analyses of a summary in printed order, each with its lowest instability. */
function Overview({
  summary,
  onSelect,
}: {
  summary: FlutterSummary;
  onSelect: (place: number) => void;
}) {
  const rows = summary.analyses.map((analysis, place) => ({
    ...analysis,
    place,
    points: summary.points.filter((point) => point.analysis === analysis.title),
  }));
  return (
    <Section title="Analyses" note="In printed order; airspeeds of zero damping">
      <Stack gap="sm">
        {rows.length > 0 && (
          <DataTable
            label="Analyses"
            testId="flutter-summaries"
            columns={[
              {
                key: "title",
                header: "Analysis",
                wraps: true,
                render: (row) => (
                  <Anchor
                    component="button"
                    type="button"
                    size="sm"
                    onClick={() => {
                      onSelect(row.place);
                    }}
                  >
                    {row.title}
                  </Anchor>
                ),
              },
              {
                key: "points",
                header: "Instabilities",
                wraps: true,
                render: (row) => row.points.map(describe).join("; ") || "none found",
              },
            ]}
            rows={rows}
            rowKey={(row) => row.place}
          />
        )}
        <TableNotes notes={summary.notes} />
      </Stack>
    </Section>
  );
}

/** Text of one instability: kind, airspeed and frequency. */
function describe(point: Point): string {
  const speed = `${fixed(point.airspeed_m_s, 1)} m/s (${fixed(point.airspeed_m_s / KNOT, 1)} kt)`;
  const where = point.is_bound ? `at or below ${speed}` : speed;
  const frequency =
    point.kind === "divergence" ? "" : `, ${fixed(point.omega_rad_s / 2 / Math.PI, 2)} Hz`;
  return `root ${String(point.root)}: ${point.kind} ${where}${frequency}`;
}

import { Button, Group, SegmentedControl, Stack, Switch, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { comparisonQuery } from "../api/queries";
import type { Comparison } from "../api/types";
import { ComparisonTable } from "../components/ComparisonTable";
import { Empty } from "../components/Empty";
import { Figure } from "../components/Figure";
import { Loaded } from "../components/Loaded";
import { PageHead } from "../components/PageHead";
import { ReportMenu } from "../components/ReportMenu";
import { SourcePicker } from "../components/SourcePicker";
import { csv, saveText } from "../lib/csv";
import { coefficientsIn, parseDerivative } from "../lib/derivatives";
import type { CompareView } from "../views";

const route = getRouteApi("/compare");

/** The same derivatives by method, condition and prediction, side by side. */
export function ComparePage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const runs = view.runs ?? [];
  const predictions = view.predictions ?? [];
  const comparison = useQuery(comparisonQuery(runs, predictions));
  const any = runs.length > 0; // a run tells the condition at which predictions are taken
  const shown = any ? comparison.data : undefined;
  const change = (part: Partial<CompareView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });

  return (
    <>
      <PageHead
        title="Compare"
        trail={[
          <Link to="/campaign" className="link" key="campaign">
            Campaign
          </Link>,
        ]}
        actions={
          shown && (
            <>
              <ReportMenu of="comparison" query={{ run_ids: runs, prediction_ids: predictions }} />
              <ExportButton comparison={shown} />
            </>
          )
        }
      />
      <div className="split split-early">
        <SourcePicker
          view={view}
          sources={shown?.sources ?? []}
          maneuverIds={shown?.maneuver_ids ?? []}
          onChange={change}
        />
        {any ? (
          <Loaded query={comparison} rows={10}>
            {(data) => <Compared comparison={data} view={view} onChange={change} />}
          </Loaded>
        ) : (
          <div className="panel">
            <Empty title="Nothing to compare yet">
              Choose a maneuver and tick one or more of its runs, or use Compare on a run.
            </Empty>
          </div>
        )}
      </div>
    </>
  );
}

interface ComparedProps {
  comparison: Comparison;
  view: CompareView;
  onChange: (change: Partial<CompareView>) => void;
}

function Compared({ comparison, view, onChange }: ComparedProps) {
  const names = comparison.rows.map((row) => row.name);
  const coefficients = coefficientsIn(names);
  const coefficient = coefficients.find((one) => one === view.coefficient) ?? coefficients[0];
  const all = view.coefficient === "all";
  const drawn = all ? coefficients : coefficient === undefined ? [] : [coefficient];
  const rows = comparison.rows.filter((row) => {
    if (view.differences === true && row.consistent !== false) return false;
    return all || parseDerivative(row.name)?.coefficient === coefficient;
  });
  const inconsistent = comparison.rows.filter((row) => row.consistent === false).length;
  const judged = comparison.rows.filter((row) => row.consistent != null).length;

  return (
    <Stack gap="md" style={{ minWidth: 0 }}>
      <Group justify="space-between">
        <SegmentedControl
          aria-label="Coefficient"
          data={[...coefficients, { value: "all", label: "All" }]}
          value={all ? "all" : (coefficient ?? "")}
          onChange={(next) => {
            onChange({ coefficient: next });
          }}
        />
        <Text size="sm" className="quiet numbers">
          {judged > 0
            ? `${judged - inconsistent} of ${judged} derivatives agree within 2σ between runs`
            : "Two runs are needed to judge consistency"}
        </Text>
      </Group>
      <div className="panel" style={{ padding: 12 }}>
        {drawn.map((one) => (
          <Figure
            key={one}
            kind="derivatives"
            title={`Derivatives of ${one}, with ±2σ`}
            params={{
              run_ids: view.runs,
              prediction_ids: view.predictions,
              coefficient: one,
            }}
          />
        ))}
      </div>
      <div className="panel">
        <Group px="sm" pt="sm">
          <Switch
            label="Only inconsistent derivatives"
            checked={view.differences === true}
            onChange={(event) => {
              onChange({ differences: event.currentTarget.checked ? true : undefined });
            }}
          />
        </Group>
        {rows.length === 0 ? (
          <Empty title={view.differences ? "All of these agree" : "No derivatives"} />
        ) : (
          <ComparisonTable sources={comparison.sources} rows={rows} />
        )}
      </div>
    </Stack>
  );
}

function ExportButton({ comparison }: { comparison: Comparison }) {
  return (
    <Button
      variant="default"
      onClick={() => {
        const { sources, rows } = comparison;
        saveText(
          csv([
            ["name", ...sources.flatMap((one) => [one.label, `${one.label} std_error`])],
            ...rows.map((row) => [
              row.name,
              ...sources.flatMap((_, place) => [
                row.values[place]?.value,
                row.values[place]?.std_error,
              ]),
            ]),
          ]),
          "flexsid-comparison.csv",
        );
      }}
    >
      Export CSV
    </Button>
  );
}

import { Alert, Button, Group, SegmentedControl, Select, Stack, Switch, Text } from "@mantine/core";
import type { Comparison, ComparisonRow } from "../../api/types";
import { coefficientsIn, parseDerivative } from "../../lib/derivatives";
import type { CompareView } from "../../views";
import { ComparisonTable } from "./ComparisonTable";
import { ComparisonVerdicts } from "./ComparisonVerdicts";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { AdequacyBadge } from "../runs/ModelAdequacy";

/** Whether runs differ from each other, or a prediction from a run. */
const differs = (row: ComparisonRow) =>
  row.consistent === false || row.values.some((value) => value?.consistent === false);

/** Coefficient of the figure that can be requested before the comparison is known. */
export const FIRST = "first";

export interface CompareTabProps {
  comparison: Comparison;
  view: CompareView;
  onChange: (change: Partial<CompareView>) => void;
  /** A point was clicked: its run. */
  onRun: (id: number) => void;
}

/** Bars with ±2σ (Fig. 17), and the same as numbers. */
export function CompareDerivatives({ comparison, view, onChange, onRun }: CompareTabProps) {
  const { sources } = comparison;
  const coefficients = coefficientsIn(comparison.rows.map((row) => row.name));
  const coefficient = coefficients.find((one) => one === view.coefficient) ?? coefficients[0];
  const all = view.coefficient === "all";
  const drawn = all ? coefficients : coefficient === undefined ? [] : [coefficient];
  const rows = comparison.rows.filter((row) => {
    if (view.differences === true && !differs(row)) return false;
    return all || parseDerivative(row.name)?.coefficient === coefficient;
  });
  const baseline = sources.findIndex((source) => source.key === view.baseline);

  const late = sources.filter((source) => source.changed_since.length > 0);

  return (
    <Stack gap="md" style={{ minWidth: 0 }}>
      {late.length > 0 && (
        <Alert color="yellow" variant="light" title="Data changed since">
          {late
            .map(
              (source) => `${source.label} was computed before ${source.changed_since.join(", ")}`,
            )
            .join("; ")}{" "}
          changed; estimate again.
        </Alert>
      )}
      <Group gap="md">
        {sources.map(
          (source) =>
            source.adequacy !== null && (
              <Group key={source.key} gap="xs">
                <Text size="sm">{source.label}</Text>
                <AdequacyBadge state={source.adequacy} />
              </Group>
            ),
        )}
      </Group>
      <Group justify="space-between">
        <SegmentedControl
          aria-label="Coefficient"
          data={[...coefficients, { value: "all", label: "All" }]}
          value={all ? "all" : (coefficient ?? "")}
          onChange={(next) => {
            onChange({ coefficient: next });
          }}
        />
        <ComparisonVerdicts comparison={comparison} />
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
              coefficient: all ? one : view.coefficient === one ? one : FIRST,
            }}
            onPick={onRun}
          />
        ))}
      </div>
      <div className="panel">
        <Group px="sm" pt="sm" align="flex-end">
          <Select
            label="Differences from"
            placeholder="no baseline"
            clearable
            w={240}
            data-testid="baseline"
            data={sources.map((source) => ({ value: source.key, label: source.label }))}
            value={sources[baseline]?.key ?? null}
            onChange={(key) => {
              onChange({ baseline: key ?? undefined });
            }}
          />
          <Switch
            label="Only derivatives that differ"
            mb={6}
            data-testid="differences"
            checked={view.differences === true}
            onChange={(event) => {
              onChange({ differences: event.currentTarget.checked ? true : undefined });
            }}
          />
        </Group>
        {rows.length === 0 ? (
          <Empty title={view.differences ? "All of these agree" : "No derivatives"}>
            {view.differences && (
              <Button
                variant="default"
                onClick={() => {
                  onChange({ differences: undefined });
                }}
              >
                Show all
              </Button>
            )}
          </Empty>
        ) : (
          <ComparisonTable
            sources={sources}
            rows={rows}
            baseline={baseline < 0 ? undefined : baseline}
          />
        )}
      </div>
    </Stack>
  );
}

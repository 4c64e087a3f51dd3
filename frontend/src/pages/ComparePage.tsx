import { Button, Tabs } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import type { ComponentType } from "react";
import { comparisonQuery } from "../api/queries";
import type { Comparison } from "../api/types";
import { ButtonLink } from "../components/controls/ButtonLink";
import { CompareAgreement } from "../components/comparison/CompareAgreement";
import {
  CompareDerivatives,
  FIRST,
  type CompareTabProps,
} from "../components/comparison/CompareDerivatives";
import { ComparePoles, CompareResponses } from "../components/comparison/CompareModels";
import { CompareSetup } from "../components/comparison/CompareSetup";
import { CompareTime } from "../components/comparison/CompareTime";
import { CompareTrends } from "../components/comparison/CompareTrends";
import { Empty } from "../components/display/Empty";
import { usePrefetchedFigure } from "../components/figures/Figure";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { PredictLinks } from "../components/runs/PredictLinks";
import { ReportMenu } from "../components/controls/ReportMenu";
import { SavedViews } from "../components/controls/SavedViews";
import { SourcePicker } from "../components/controls/SourcePicker";
import { csv, saveText } from "../lib/csv";
import { COMPARE_TABS, type CompareView } from "../views";

const route = getRouteApi("/compare");

/** Comparison of derivatives by method, condition and prediction. */
export function ComparePage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const runs = view.runs ?? [];
  const predictions = view.predictions ?? [];
  const comparison = useQuery(comparisonQuery(runs, predictions));
  const any = runs.length > 0; // predictions are evaluated at the condition of a run
  const shown = any ? comparison.data : undefined;
  usePrefetchedFigure(
    "derivatives",
    any && (view.tab ?? "derivatives") === "derivatives" && view.coefficient !== "all"
      ? {
          run_ids: view.runs,
          prediction_ids: view.predictions,
          coefficient: view.coefficient ?? FIRST,
        }
      : null,
  );
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
          <>
            <SavedViews page="compare" />
            {shown && (
              <>
                <ReportMenu
                  of="comparison"
                  query={{ run_ids: runs, prediction_ids: predictions }}
                />
                <ExportButton comparison={shown} />
                <ButtonLink to="/validation" search={{ runs }} variant="default">
                  Validate
                </ButtonLink>
                <PredictLinks runs={runs} />
              </>
            )}
          </>
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
            {(data) => (
              <Compared
                comparison={data}
                view={view}
                onChange={change}
                onRun={(id) => void navigate({ to: "/runs/$id", params: { id } })}
              />
            )}
          </Loaded>
        ) : (
          <div className="panel">
            <Empty title="No runs selected">
              Select a maneuver and one or more of its runs, or use Compare on a run.
            </Empty>
          </div>
        )}
      </div>
    </>
  );
}

const TABS: Record<(typeof COMPARE_TABS)[number], string> = {
  derivatives: "Derivatives",
  agreement: "Agreement",
  trends: "Trends",
  responses: "Responses",
  poles: "Poles and fits",
  time: "Time",
  setup: "Setup",
};

const CONTENT: Record<(typeof COMPARE_TABS)[number], ComponentType<CompareTabProps>> = {
  derivatives: CompareDerivatives,
  agreement: CompareAgreement,
  trends: CompareTrends,
  responses: CompareResponses,
  poles: ComparePoles,
  time: CompareTime,
  setup: CompareSetup,
};

function Compared(props: CompareTabProps) {
  const tab = props.view.tab ?? "derivatives";
  const Content = CONTENT[tab];
  return (
    <Tabs
      value={tab}
      style={{ minWidth: 0 }}
      onChange={(next) => {
        props.onChange({ tab: COMPARE_TABS.find((one) => one === next) });
      }}
    >
      <Tabs.List mb="md">
        {COMPARE_TABS.map((one) => (
          <Tabs.Tab key={one} value={one} data-testid={`tab-${one}`}>
            {TABS[one]}
          </Tabs.Tab>
        ))}
      </Tabs.List>
      <Tabs.Panel value={tab}>
        <Content {...props} />
      </Tabs.Panel>
    </Tabs>
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
            [
              "name",
              ...sources.flatMap((one) =>
                ["", " std_error", " repeatability", " rests_on"].map((of) => one.label + of),
              ),
            ],
            ...rows.map((row) => [
              row.name,
              ...sources.flatMap((_, index) => [
                row.values[index]?.value,
                row.values[index]?.std_error,
                row.values[index]?.repeatability,
                row.values[index]?.rests_on,
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

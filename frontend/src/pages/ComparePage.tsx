import { Button } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { comparisonQuery } from "../api/queries";
import type { Comparison } from "../api/types";
import { CompareAmplitudes } from "../components/comparison/CompareAmplitudes";
import { CompareAgreement } from "../components/comparison/CompareAgreement";
import {
  CompareDerivatives,
  FIRST,
  type CompareTabProps,
} from "../components/comparison/CompareDerivatives";
import { ComparePoles, CompareResponses } from "../components/comparison/CompareModels";
import { CompareSetup } from "../components/comparison/CompareSetup";
import { CompareTime } from "../components/comparison/CompareTime";
import { CompareValidation } from "../components/comparison/CompareValidation";
import { CompareTrends } from "../components/comparison/CompareTrends";
import { Empty } from "../components/display/Empty";
import { usePrefetchedFigure } from "../components/figures/Figure";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { SectionTabs, type SectionContents } from "../components/frame/SectionTabs";
import { PredictLinks } from "../components/runs/PredictLinks";
import { ReportMenu } from "../components/controls/ReportMenu";
import { SavedViews } from "../components/controls/SavedViews";
import { SourcePicker } from "../components/controls/SourcePicker";
import { csv, saveText } from "../lib/text/csv";
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

const TAB_NAMES = {
  derivatives: "Derivatives",
  trends: "Trends",
  responses: "Models",
  validation: "Validation",
};

type CompareSection = (typeof COMPARE_TABS)[keyof typeof COMPARE_TABS][number];

function Compared(props: CompareTabProps) {
  const contents: SectionContents<CompareSection> = {
    derivatives: ["Derivatives", <CompareDerivatives {...props} />],
    agreement: ["Agreement", <CompareAgreement {...props} />],
    setup: ["Setup differences", <CompareSetup {...props} />],
    trends: ["Over the condition", <CompareTrends {...props} />],
    amplitudes: ["Over amplitude", <CompareAmplitudes {...props} />],
    responses: ["Frequency responses", <CompareResponses {...props} />],
    poles: ["Poles and fits", <ComparePoles {...props} />],
    time: ["Time histories", <CompareTime {...props} />],
    validation: ["Predictions and held-out data", <CompareValidation {...props} />],
  };
  return (
    <SectionTabs
      label="Comparison"
      sections={COMPARE_TABS}
      titles={TAB_NAMES}
      contents={contents}
      tab={props.view.tab ?? "derivatives"}
      onTab={(tab) => {
        props.onChange({ tab });
      }}
    />
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

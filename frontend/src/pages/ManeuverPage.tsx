import { Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { maneuverQuery } from "../api/queries";
import type { Maneuver } from "../api/types";
import { ButtonLink } from "../components/controls/ButtonLink";
import { ConditionFacts } from "../components/display/ConditionFacts";
import { Loaded } from "../components/display/Loaded";
import { BodeTab } from "../components/maneuvers/BodeTab";
import { CompatibilityTab } from "../components/quality/CompatibilityTab";
import { ManeuverRuns } from "../components/maneuvers/ManeuverRuns";
import { NotesButton } from "../components/display/Notes";
import { GreyBoxTab } from "../components/maneuvers/GreyBoxTab";
import { OutputOnlyTab } from "../components/maneuvers/OutputOnlyTab";
import { PageHead } from "../components/frame/PageHead";
import { SectionTabs, type SectionContents } from "../components/frame/SectionTabs";
import { PlotMatrixTab } from "../components/maneuvers/PlotMatrixTab";
import { QualityTab } from "../components/quality/QualityTab";
import { ReconstructionTab } from "../components/maneuvers/ReconstructionTab";
import { SpectraTab } from "../components/maneuvers/SpectraTab";
import { TimeHistoryTab } from "../components/maneuvers/TimeHistoryTab";
import { TransferFunctionTab } from "../components/maneuvers/TransferFunctionTab";
import { flightName } from "../lib/text/format";
import { MANEUVER_TABS, type ManeuverView } from "../views";

const route = getRouteApi("/maneuvers/$id");

const TAB_NAMES = {
  time: "Time histories",
  quality: "Quality",
  spectra: "Spectra",
  reconstruction: "Reconstruction",
  bode: "Frequency responses",
  "grey-box": "Grey box",
  runs: "Runs",
};

type ManeuverSection = (typeof MANEUVER_TABS)[keyof typeof MANEUVER_TABS][number];

/** One maneuver: time histories, quality, spectra, responses and runs. */
export function ManeuverPage() {
  const { id } = route.useParams();
  const maneuver = useQuery(maneuverQuery(id));
  return (
    <Loaded query={maneuver} page={`Maneuver ${id}`}>
      {(data) => <OneManeuver maneuver={data} />}
    </Loaded>
  );
}

function OneManeuver({ maneuver }: { maneuver: Maneuver }) {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const change = (part: Partial<ManeuverView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });
  const tabProps = { maneuver, view, onChange: change };
  const contents: SectionContents<ManeuverSection> = {
    time: ["Time histories", <TimeHistoryTab {...tabProps} />],
    quality: ["Quality", <QualityTab {...tabProps} />],
    compatibility: ["Compatibility", <CompatibilityTab {...tabProps} />],
    spectra: ["Spectra", <SpectraTab {...tabProps} />],
    inputs: ["Correlation of channels", <PlotMatrixTab {...tabProps} />],
    reconstruction: ["Reconstruction", <ReconstructionTab {...tabProps} />],
    bode: ["Bode", <BodeTab {...tabProps} />],
    "transfer-function": ["Transfer function", <TransferFunctionTab {...tabProps} />],
    "output-only": ["Output-only modes", <OutputOnlyTab {...tabProps} />],
    "grey-box": ["Grey box", <GreyBoxTab {...tabProps} />],
    runs: ["Runs", <ManeuverRuns {...tabProps} />],
  };
  return (
    <>
      <PageHead
        title={maneuver.label}
        trail={[
          <Link to="/campaign" className="link" key="campaign">
            Campaign
          </Link>,
          <Link to="/flights/$id" params={{ id: maneuver.flight_id }} className="link" key="flight">
            {flightName(maneuver.flight_number)}
          </Link>,
        ]}
        aside={
          <Text size="sm" className="quiet">
            {maneuver.aircraft_name}
            {maneuver.fta !== null && `, FTA ${maneuver.fta}`}, {maneuver.axis}
          </Text>
        }
        actions={
          <>
            <NotesButton
              filter={{ maneuver_id: maneuver.id }}
              topics={[{ subject: "maneuver", key: String(maneuver.id), label: maneuver.label }]}
            />
            <ButtonLink
              to="/maneuvers/$id/new-run"
              params={{ id: maneuver.id }}
              data-testid="new-run"
            >
              New run
            </ButtonLink>
          </>
        }
      />
      <ConditionFacts maneuver={maneuver} />
      {maneuver.note !== "" && (
        <Text size="sm" mt="xs" className="quiet" style={{ whiteSpace: "pre-line" }}>
          {maneuver.note}
        </Text>
      )}
      <SectionTabs
        label="Maneuver"
        sections={MANEUVER_TABS}
        titles={TAB_NAMES}
        contents={contents}
        tab={view.tab ?? "time"}
        onTab={(tab) => {
          change({ tab });
        }}
      />
    </>
  );
}

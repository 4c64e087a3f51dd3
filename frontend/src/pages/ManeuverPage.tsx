import { Tabs, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { maneuverQuery } from "../api/queries";
import type { Maneuver } from "../api/types";
import { ButtonLink } from "../components/controls/ButtonLink";
import { ConditionFacts } from "../components/display/ConditionFacts";
import { Loaded } from "../components/display/Loaded";
import { BodeTab } from "../components/maneuvers/BodeTab";
import { CompatibilityTab } from "../components/maneuvers/CompatibilityTab";
import { ManeuverRuns } from "../components/maneuvers/ManeuverRuns";
import { Notes } from "../components/display/Notes";
import { OutputOnlyTab } from "../components/maneuvers/OutputOnlyTab";
import { PageHead } from "../components/frame/PageHead";
import { PlotMatrixTab } from "../components/maneuvers/PlotMatrixTab";
import { QualityTab } from "../components/maneuvers/QualityTab";
import { ReconstructionTab } from "../components/maneuvers/ReconstructionTab";
import { SpectraTab } from "../components/maneuvers/SpectraTab";
import { TimeHistoryTab } from "../components/maneuvers/TimeHistoryTab";
import { TransferFunctionTab } from "../components/maneuvers/TransferFunctionTab";
import { flightName } from "../lib/format";
import { MANEUVER_TABS, type ManeuverView } from "../views";

const route = getRouteApi("/maneuvers/$id");

const TAB_NAMES: Record<(typeof MANEUVER_TABS)[number], string> = {
  time: "Time histories",
  quality: "Quality",
  compatibility: "Compatibility",
  spectra: "Spectra",
  inputs: "Correlation",
  reconstruction: "Reconstruction",
  bode: "Bode",
  "transfer-function": "Transfer function",
  "output-only": "Output-only modes",
  runs: "Runs",
};

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
  const tab = view.tab ?? "time";
  const change = (part: Partial<ManeuverView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });

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
          <ButtonLink
            to="/maneuvers/$id/new-run"
            params={{ id: maneuver.id }}
            data-testid="new-run"
          >
            New run
          </ButtonLink>
        }
      />
      <ConditionFacts maneuver={maneuver} />
      {maneuver.note !== "" && (
        <Text size="sm" mt="xs" className="quiet" style={{ whiteSpace: "pre-line" }}>
          {maneuver.note}
        </Text>
      )}
      <Tabs
        mt="lg"
        value={tab}
        onChange={(next) => {
          change({ tab: MANEUVER_TABS.find((one) => one === next) });
        }}
      >
        <Tabs.List aria-label="Maneuver">
          {MANEUVER_TABS.map((name) => (
            <Tabs.Tab key={name} value={name} data-testid={`tab-${name}`}>
              {TAB_NAMES[name]}
            </Tabs.Tab>
          ))}
        </Tabs.List>
        <Tabs.Panel value="time" pt="md">
          <TimeHistoryTab maneuver={maneuver} view={view} onChange={change} />
        </Tabs.Panel>
        <Tabs.Panel value="quality" pt="md">
          <QualityTab maneuver={maneuver} view={view} onChange={change} />
        </Tabs.Panel>
        <Tabs.Panel value="compatibility" pt="md">
          <CompatibilityTab maneuver={maneuver} />
        </Tabs.Panel>
        <Tabs.Panel value="reconstruction" pt="md">
          <ReconstructionTab maneuver={maneuver} view={view} onChange={change} />
        </Tabs.Panel>
        <Tabs.Panel value="spectra" pt="md">
          <SpectraTab maneuver={maneuver} view={view} onChange={change} />
        </Tabs.Panel>
        <Tabs.Panel value="inputs" pt="md">
          <PlotMatrixTab maneuver={maneuver} view={view} onChange={change} />
        </Tabs.Panel>
        <Tabs.Panel value="bode" pt="md">
          <BodeTab maneuver={maneuver} view={view} onChange={change} />
        </Tabs.Panel>
        <Tabs.Panel value="output-only" pt="md">
          <OutputOnlyTab maneuver={maneuver} view={view} onChange={change} />
        </Tabs.Panel>
        <Tabs.Panel value="transfer-function" pt="md">
          <TransferFunctionTab maneuver={maneuver} view={view} onChange={change} />
        </Tabs.Panel>
        <Tabs.Panel value="runs" pt="md">
          <ManeuverRuns maneuver={maneuver} view={view} onChange={change} />
        </Tabs.Panel>
      </Tabs>
      <div style={{ marginTop: 16 }}>
        <Notes
          filter={{ maneuver_id: maneuver.id }}
          topics={[{ subject: "maneuver", key: String(maneuver.id), label: maneuver.label }]}
        />
      </div>
    </>
  );
}

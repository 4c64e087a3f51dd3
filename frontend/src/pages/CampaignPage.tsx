import { Group, SegmentedControl, Stack } from "@mantine/core";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { getRouteApi } from "@tanstack/react-router";
import { useCallback } from "react";
import { maneuverFacetsQuery, maneuversQuery } from "../api/queries";
import { BulkActions } from "../components/controls/BulkActions";
import { ButtonLink } from "../components/controls/ButtonLink";
import { CampaignProgress } from "../components/maneuvers/CampaignProgress";
import { Empty } from "../components/display/Empty";
import { Figure } from "../components/figures/Figure";
import { GroundTestAlarm } from "../components/frame/GroundTestAlarm";
import { ListFoot } from "../components/controls/ListFoot";
import { Loaded } from "../components/display/Loaded";
import { apiFilters, ManeuverFilters } from "../components/maneuvers/ManeuverFilters";
import { ManeuverList } from "../components/maneuvers/ManeuverList";
import { AssessButton } from "../components/quality/QualityAssessment";
import { CampaignAmplitudes } from "../components/maneuvers/CampaignAmplitudes";
import { CampaignCoverage, CampaignWarnings } from "../components/maneuvers/CampaignCoverage";
import { PageHead } from "../components/frame/PageHead";
import { Sections } from "../components/frame/SectionTabs";
import { ReportMenu } from "../components/controls/ReportMenu";
import { SavedViews } from "../components/controls/SavedViews";
import { count } from "../lib/text/format";
import { oneOf } from "../lib/urlState";
import { CAMPAIGN_COLUMNS, type CampaignView } from "../views";

const route = getRouteApi("/campaign");

/** Maneuvers of the campaign in a table and in the flight envelope. */
export function CampaignPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const filters = apiFilters(view);
  const usual = view.columns === "quality" ? "verdict" : "id";
  const sort = view.sort ?? usual;
  const list = useInfiniteQuery(maneuversQuery(filters, sort));
  const facets = useQuery(maneuverFacetsQuery(filters));
  const shown = list.data?.pages.flatMap((page) => page.items) ?? [];
  const selected = view.selected ?? [];
  const change = useCallback(
    (part: Partial<CampaignView>) =>
      void navigate({ search: (previous) => ({ ...previous, ...part }) }),
    [navigate],
  );
  const filtered = Object.values(filters).some((value) => value !== undefined);

  const table = (
    <div className="campaign">
      <Stack gap="sm">
        <ManeuverFilters view={view} choices={facets.data?.choices} onChange={change} />
        <Group justify="space-between">
          <SegmentedControl
            aria-label="Columns"
            data={[
              { value: "runs", label: "Condition and runs" },
              { value: "quality", label: "Data quality" },
            ]}
            value={view.columns ?? "runs"}
            onChange={(next) => {
              change({ columns: oneOf(next, CAMPAIGN_COLUMNS), sort: undefined });
            }}
          />
          {view.columns === "quality" && <AssessButton />}
        </Group>
        <div className="panel">
          <Loaded query={list} rows={12}>
            {() =>
              shown.length === 0 ? (
                <Nothing filtered={filtered} />
              ) : (
                <ManeuverList
                  columns={view.columns}
                  maneuvers={shown}
                  selected={selected}
                  onSelect={(ids) => {
                    change({ selected: ids.length > 0 ? ids : undefined });
                  }}
                  sort={sort}
                  onSort={(next) => {
                    change({ sort: next === usual ? undefined : next });
                  }}
                />
              )
            }
          </Loaded>
        </div>
        <ListFoot
          counts={
            list.data === undefined
              ? ""
              : `${shown.length} of ${count(facets.data?.total ?? shown.length, "maneuver")}`
          }
          testId="maneuver-count"
          list={list}
        />
      </Stack>
      <aside className="panel" style={{ padding: 12 }}>
        <Figure
          kind="envelope"
          title="Envelope"
          params={{ ...filters }}
          height={360}
          revision="envelope"
          onPick={(id) => void navigate({ to: "/maneuvers/$id", params: { id }, search: {} })}
        />
      </aside>
    </div>
  );
  return (
    <>
      <PageHead
        title="Campaign"
        actions={
          <>
            {selected.length > 0 && (
              <BulkActions
                records="maneuvers"
                ids={selected}
                tags={(facets.data?.choices.tag ?? []).map((tag) => tag.value)}
                deleted={view.deleted === true}
                onClear={() => {
                  change({ selected: undefined });
                }}
              >
                <NewRuns ids={selected} />
              </BulkActions>
            )}
            <SavedViews page="campaign" />
            {shown.length > 0 && <ReportMenu of="campaign" query={{ ...filters }} />}
            <ButtonLink variant="default" to="/import" data-testid="import">
              Import
            </ButtonLink>
          </>
        }
      />
      <CampaignProgress />
      <GroundTestAlarm />
      <Sections
        names={["maneuvers", "coverage", "amplitudes", "warnings"]}
        contents={{
          maneuvers: ["Maneuvers", table],
          coverage: [
            "Derivatives over the envelope",
            <CampaignCoverage view={view} onChange={change} />,
          ],
          amplitudes: ["Repeated amplitudes", <CampaignAmplitudes view={view} />],
          warnings: ["Open warnings", <CampaignWarnings view={view} />],
        }}
      />
    </>
  );
}

function NewRuns({ ids }: { ids: number[] }) {
  const [first, ...additional] = ids;
  if (first === undefined) return null;
  return (
    <ButtonLink
      to="/maneuvers/$id/new-run"
      params={{ id: first }}
      search={{ additional_maneuvers: additional.length > 0 ? additional : undefined }}
      data-testid="run-selected"
    >
      New runs
    </ButtonLink>
  );
}

function Nothing({ filtered }: { filtered: boolean }) {
  return filtered ? (
    <Empty title="No maneuver matches these filters">Widen or clear them.</Empty>
  ) : (
    <Empty title="No maneuvers yet">
      Import recorded data, or load the demonstration campaign: <code>flexsid demo</code>.
    </Empty>
  );
}

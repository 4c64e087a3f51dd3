import { Button, Group, Stack, Text } from "@mantine/core";
import { useInfiniteQuery } from "@tanstack/react-query";
import { getRouteApi } from "@tanstack/react-router";
import { useCallback } from "react";
import { maneuversQuery } from "../api/queries";
import { ButtonLink } from "../components/ButtonLink";
import { Empty } from "../components/Empty";
import { Figure } from "../components/Figure";
import { GroundTestAlarm } from "../components/GroundTestAlarm";
import { Loaded } from "../components/Loaded";
import { apiFilters, ManeuverFilters } from "../components/ManeuverFilters";
import { ManeuverList } from "../components/ManeuverList";
import { PageHead } from "../components/PageHead";
import type { CampaignView } from "../views";

const route = getRouteApi("/");

/** Every maneuver of the campaign, where it lies in the envelope and where it stands. */
export function CampaignPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const filters = apiFilters(view);
  const sort = view.sort ?? "id";
  const list = useInfiniteQuery(maneuversQuery(filters, sort));
  const selected = view.selected ?? [];
  const change = useCallback(
    (part: Partial<CampaignView>) =>
      void navigate({ search: (previous) => ({ ...previous, ...part }) }),
    [navigate],
  );
  const filtered = Object.values(filters).some((value) => value !== undefined);

  return (
    <>
      <PageHead
        title="Campaign"
        actions={
          <>
            {selected.length > 0 && (
              <Selection
                ids={selected}
                onClear={() => {
                  change({ selected: undefined });
                }}
              />
            )}
            <ButtonLink variant="default" to="/import" data-testid="import">
              Import
            </ButtonLink>
          </>
        }
      />
      <GroundTestAlarm />
      <div className="campaign">
        <Stack gap="sm">
          <ManeuverFilters view={view} onChange={change} />
          <div className="panel">
            <Loaded query={list} rows={12}>
              {({ pages }) => {
                const maneuvers = pages.flatMap((page) => page.items);
                return maneuvers.length === 0 ? (
                  <Nothing filtered={filtered} />
                ) : (
                  <ManeuverList
                    maneuvers={maneuvers}
                    selected={selected}
                    onSelect={(ids) => {
                      change({ selected: ids });
                    }}
                    sort={sort}
                    onSort={(next) => {
                      change({ sort: next === "id" ? undefined : next });
                    }}
                  />
                );
              }}
            </Loaded>
          </div>
          <Group justify="space-between">
            <Text
              size="xs"
              className="quiet numbers"
              aria-live="polite"
              data-testid="maneuver-count"
            >
              {list.data !== undefined && countText(list.data.pages, list.hasNextPage)}
            </Text>
            {list.hasNextPage && (
              <Button
                variant="default"
                loading={list.isFetchingNextPage}
                onClick={() => void list.fetchNextPage()}
              >
                Load more
              </Button>
            )}
          </Group>
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
    </>
  );
}

function countText(pages: { items: unknown[] }[], more: boolean): string {
  const count = pages.reduce((sum, page) => sum + page.items.length, 0);
  return `${more ? "First " : ""}${count} ${count === 1 ? "maneuver" : "maneuvers"}`;
}

function Selection({ ids, onClear }: { ids: number[]; onClear: () => void }) {
  const [first, ...also] = ids;
  if (first === undefined) return null;
  return (
    <>
      <Text size="sm" className="quiet numbers">
        {ids.length} selected
      </Text>
      <Button variant="subtle" onClick={onClear}>
        Clear selection
      </Button>
      <ButtonLink
        to="/maneuvers/$id/new-run"
        params={{ id: first }}
        search={{ also: also.length > 0 ? also : undefined }}
        data-testid="run-selected"
      >
        New runs
      </ButtonLink>
    </>
  );
}

function Nothing({ filtered }: { filtered: boolean }) {
  return filtered ? (
    <Empty title="No maneuver matches these filters">Widen or clear them.</Empty>
  ) : (
    <Empty title="No maneuvers yet">
      Import recorded data with the button above, or fill the workbench with the demonstration
      campaign: <code>flexsid demo</code>.
    </Empty>
  );
}

import { Button, Group, Stack, Switch, Text } from "@mantine/core";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { getRouteApi } from "@tanstack/react-router";
import { useCallback } from "react";
import { runFacetsQuery, runListQuery } from "../api/queries";
import { METHODS, STATES, type RunFilters, type RunItem } from "../api/types";
import { BulkActions } from "../components/BulkActions";
import { CompareLink } from "../components/CompareLink";
import { Empty } from "../components/Empty";
import { FacetSelect } from "../components/FacetSelect";
import { FilterInput } from "../components/FilterInput";
import { SearchIcon } from "../components/icons";
import { Loaded } from "../components/Loaded";
import { PageHead } from "../components/PageHead";
import { RunList } from "../components/RunList";
import { SavedViews } from "../components/SavedViews";
import { count } from "../lib/format";
import { integer } from "../lib/urlState";
import type { RunsView } from "../views";

const route = getRouteApi("/runs");

/** Every run of the workbench: found, tagged, compared. */
export function RunsPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const filters = apiFilters(view);
  const sort = view.sort ?? "-id";
  const list = useInfiniteQuery(runListQuery(filters, sort));
  const facets = useQuery(runFacetsQuery(filters));
  const selected = view.selected ?? [];
  const change = useCallback(
    (part: Partial<RunsView>) =>
      void navigate({ search: (previous) => ({ ...previous, ...part }) }),
    [navigate],
  );
  const shown = list.data?.pages.flatMap((page) => page.items) ?? [];
  const chosen = shown.filter((run) => selected.includes(run.id));

  return (
    <>
      <PageHead
        title="Runs"
        actions={
          <>
            {selected.length > 0 && (
              <BulkActions
                what="runs"
                ids={selected}
                tags={(facets.data?.choices.tag ?? []).map((tag) => tag.value)}
                deleted={view.deleted === true}
                onClear={() => {
                  change({ selected: undefined });
                }}
              >
                <CompareSelected chosen={chosen} selected={selected} />
              </BulkActions>
            )}
            <SavedViews page="runs" />
          </>
        }
      />
      <Stack gap="sm">
        <Filters view={view} choices={facets.data?.choices} onChange={change} />
        <div className="panel">
          <Loaded query={list} rows={12}>
            {() =>
              shown.length === 0 ? (
                <Nothing filtered={Object.values(filters).some((value) => value !== undefined)} />
              ) : (
                <RunList
                  runs={shown}
                  selected={selected}
                  onSelect={(ids) => {
                    change({ selected: ids.length > 0 ? ids : undefined });
                  }}
                  sort={sort}
                  onSort={(next) => {
                    change({ sort: next === "-id" ? undefined : next });
                  }}
                />
              )
            }
          </Loaded>
        </div>
        <Group justify="space-between">
          <Text size="xs" className="quiet numbers" aria-live="polite" data-testid="run-count">
            {list.data !== undefined &&
              `${shown.length} of ${count(facets.data?.total ?? shown.length, "run")}`}
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
    </>
  );
}

/** Runs that are selected but not on the loaded pages are compared too. */
function CompareSelected({ chosen, selected }: { chosen: RunItem[]; selected: number[] }) {
  const known = new Map(chosen.map((run) => [run.id, run]));
  const done = selected.filter((id) => known.get(id)?.state === "succeeded" || !known.has(id));
  return (
    <CompareLink
      runs={done.map((id) => ({ id, prediction_id: known.get(id)?.prediction_id ?? null }))}
      label={`Compare ${done.length}`}
    />
  );
}

function apiFilters(view: RunsView): RunFilters {
  return {
    search: view.search,
    aircraft_id: view.aircraft,
    flight_id: view.flight,
    maneuver_id: view.maneuver,
    fta: view.fta,
    method: view.method,
    state: view.state,
    tag: view.tag,
    deleted: view.deleted,
  };
}

interface FilterProps {
  view: RunsView;
  choices: Record<string, { value: string; label: string; count: number }[]> | undefined;
  onChange: (change: Partial<RunsView>) => void;
}

const NONE: Partial<RunsView> = {
  search: undefined,
  aircraft: undefined,
  flight: undefined,
  maneuver: undefined,
  fta: undefined,
  method: undefined,
  state: undefined,
  tag: undefined,
  deleted: undefined,
};

function Filters({ view, choices, onChange }: FilterProps) {
  const active = Object.values(apiFilters(view)).some((value) => value !== undefined);
  return (
    <Group gap="sm" align="flex-end" role="search" aria-label="Filter runs">
      <FilterInput
        label="Search"
        placeholder="Maneuver, author, number"
        w={200}
        leftSection={<SearchIcon size={12} />}
        data-testid="filter-search"
        value={view.search ?? ""}
        onCommit={(search) => {
          onChange({ search: search === "" ? undefined : search });
        }}
      />
      <FacetSelect
        label="Flight"
        width={96}
        testId="filter-flight"
        choices={choices?.flight_id}
        value={view.flight?.toString()}
        onChange={(value) => {
          onChange({ flight: integer(value) });
        }}
      />
      <FacetSelect
        label="FTA"
        width={104}
        testId="filter-fta"
        choices={choices?.fta}
        value={view.fta?.toString()}
        onChange={(value) => {
          onChange({ fta: integer(value) });
        }}
      />
      <FacetSelect
        label="Method"
        width={104}
        testId="filter-method"
        choices={choices?.method}
        value={view.method}
        onChange={(value) => {
          onChange({ method: METHODS.find((one) => one === value) });
        }}
      />
      <FacetSelect
        label="State"
        width={140}
        testId="filter-state"
        choices={choices?.state}
        value={view.state}
        onChange={(value) => {
          onChange({ state: STATES.find((one) => one === value) });
        }}
      />
      <FacetSelect
        label="Tag"
        width={130}
        testId="filter-tag"
        choices={choices?.tag}
        value={view.tag}
        onChange={(tag) => {
          onChange({ tag });
        }}
      />
      <Switch
        label="Deleted"
        mb={6}
        checked={view.deleted === true}
        data-testid="filter-deleted"
        onChange={(event) => {
          onChange({ deleted: event.currentTarget.checked || undefined, selected: undefined });
        }}
      />
      {active && (
        <Button
          variant="subtle"
          data-testid="filter-clear"
          onClick={() => {
            onChange(NONE);
          }}
        >
          Clear
        </Button>
      )}
    </Group>
  );
}

function Nothing({ filtered }: { filtered: boolean }) {
  return filtered ? (
    <Empty title="No run matches these filters">Widen or clear them.</Empty>
  ) : (
    <Empty title="No runs yet">Open a maneuver of the campaign and ask for a new run.</Empty>
  );
}

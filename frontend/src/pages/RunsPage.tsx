import { Select, Stack, Switch } from "@mantine/core";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { getRouteApi } from "@tanstack/react-router";
import { useCallback } from "react";
import { runFacetsQuery, runListQuery } from "../api/queries";
import { ADEQUACIES, type RunFilters, type RunItem } from "../api/types";
import { BulkActions } from "../components/controls/BulkActions";
import { ButtonLink } from "../components/controls/ButtonLink";
import { CompareLink } from "../components/runs/CompareLink";
import { Empty } from "../components/display/Empty";
import { ListFilters } from "../components/controls/ListFilters";
import { ListFoot } from "../components/controls/ListFoot";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { RunList } from "../components/runs/RunList";
import { PredictLinks } from "../components/runs/PredictLinks";
import { SavedViews } from "../components/controls/SavedViews";
import { count } from "../lib/text/format";
import { oneOf } from "../lib/urlState";
import type { RunsView } from "../views";

const route = getRouteApi("/runs");

/** List of all runs, to filter, tag and compare. */
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
  const filtered = FILTERS.some((key) => view[key] !== undefined);
  const selectedRuns = shown.filter((run) => selected.includes(run.id));

  return (
    <>
      <PageHead
        title="Runs"
        actions={
          <>
            {selected.length > 0 && (
              <BulkActions
                records="runs"
                ids={selected}
                tags={(facets.data?.choices.tag ?? []).map((tag) => tag.value)}
                deleted={view.deleted === true}
                onClear={() => {
                  change({ selected: undefined });
                }}
              >
                <CompareSelected runs={selectedRuns} selected={selected} />
              </BulkActions>
            )}
            <ButtonLink to="/run-templates" variant="default">
              Templates
            </ButtonLink>
            <SavedViews page="runs" />
          </>
        }
      />
      <Stack gap="sm">
        <ListFilters
          records="runs"
          hint="Maneuver, author, number"
          view={view}
          choices={facets.data?.choices}
          onChange={change}
          onClear={
            filtered
              ? () => {
                  change(Object.fromEntries(FILTERS.map((key) => [key, undefined])));
                }
              : undefined
          }
        >
          <Select
            label="Adequacy"
            placeholder="any"
            w={126}
            clearable
            data-testid="filter-adequacy"
            data={[...ADEQUACIES]}
            value={view.adequacy ?? null}
            onChange={(value) => {
              change({ adequacy: oneOf(value, ADEQUACIES) });
            }}
          />
          <Switch
            label="Derived"
            mb={6}
            checked={view.derived === true}
            data-testid="filter-derived"
            onChange={(event) => {
              change({ derived: event.currentTarget.checked || undefined, selected: undefined });
            }}
          />
        </ListFilters>
        <div className="panel">
          <Loaded query={list} rows={12}>
            {() =>
              shown.length === 0 ? (
                <Nothing filtered={filtered} />
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
        <ListFoot
          counts={
            list.data === undefined
              ? ""
              : `${shown.length} of ${count(facets.data?.total ?? shown.length, "run")}`
          }
          testId="run-count"
          list={list}
        />
      </Stack>
    </>
  );
}

/** Runs that are selected but not on the loaded pages are compared too. */
function CompareSelected({ runs, selected }: { runs: RunItem[]; selected: number[] }) {
  const known = new Map(runs.map((run) => [run.id, run]));
  const done = selected.filter((id) => known.get(id)?.state === "succeeded" || !known.has(id));
  return (
    <>
      <CompareLink
        runs={done.map((id) => ({ id, prediction_id: known.get(id)?.prediction_id ?? null }))}
        label={`Compare ${done.length}`}
      />
      <PredictLinks runs={done} />
    </>
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
    adequacy: view.adequacy,
    tag: view.tag,
    deleted: view.deleted,
    derived: view.derived,
  };
}

const FILTERS = [
  "search",
  "aircraft",
  "flight",
  "maneuver",
  "fta",
  "method",
  "state",
  "adequacy",
  "tag",
  "deleted",
  "derived",
] as const satisfies readonly (keyof RunsView)[];

function Nothing({ filtered }: { filtered: boolean }) {
  return filtered ? (
    <Empty title="No run matches these filters">Widen or clear them.</Empty>
  ) : (
    <Empty title="No runs yet">Open a maneuver of the campaign and submit a new run.</Empty>
  );
}

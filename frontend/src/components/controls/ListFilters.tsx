import { Button, Group, Switch } from "@mantine/core";
import type { ReactNode } from "react";
import { METHODS, STATES, type Facets } from "../../api/types";
import { integer } from "../../lib/urlState";
import type { RunsView } from "../../views";
import { FacetSelect } from "./FacetSelect";
import { FilterInput } from "./FilterInput";
import { SearchIcon } from "../display/icons";
import { flightNumber } from "../../lib/text/format";

/** What lists of maneuvers and of runs are both filtered by. */
type Shared = Pick<
  RunsView,
  "search" | "flight" | "fta" | "method" | "state" | "tag" | "deleted" | "selected"
>;

interface Props {
  records: "maneuvers" | "runs";
  hint: string;
  view: Shared;
  choices: Facets["choices"] | undefined;
  onChange: (change: Partial<Shared>) => void;
  /** Takes every filter away; absent while there is none. */
  onClear: (() => void) | undefined;
  /** Filters of one list alone. */
  children?: ReactNode;
}

/** Filters with how many each choice would leave. */
export function ListFilters({ records, hint, view, choices, onChange, onClear, children }: Props) {
  return (
    <Group gap="sm" align="flex-end" role="search" aria-label={`Filter ${records}`}>
      <FilterInput
        label="Search"
        placeholder={hint}
        w={hint.length > 10 ? 200 : 150}
        leftSection={<SearchIcon size={12} />}
        data-testid="filter-search"
        value={view.search ?? ""}
        onCommit={(search) => {
          onChange({ search: search === "" ? undefined : search });
        }}
      />
      <FacetSelect
        label="Flight"
        width={92}
        testId="filter-flight"
        choices={choices?.flight_id?.map((one) => ({
          ...one,
          label: flightNumber(Number(one.label)),
        }))}
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
      {children}
      <FacetSelect
        label="Method"
        width={100}
        testId="filter-method"
        choices={choices?.method}
        value={view.method}
        onChange={(value) => {
          onChange({ method: METHODS.find((one) => one === value) });
        }}
      />
      <FacetSelect
        label={records === "runs" ? "State" : "Run state"}
        width={138}
        testId="filter-state"
        choices={choices?.state}
        value={view.state}
        onChange={(value) => {
          onChange({ state: STATES.find((one) => one === value) });
        }}
      />
      <FacetSelect
        label="Tag"
        width={120}
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
      {onClear !== undefined && (
        <Button variant="subtle" data-testid="filter-clear" onClick={onClear}>
          Clear
        </Button>
      )}
    </Group>
  );
}

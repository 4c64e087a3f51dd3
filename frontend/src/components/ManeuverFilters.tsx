import { Button, Group, Input, Switch } from "@mantine/core";
import type { ReactNode } from "react";
import { METHODS, STATES, type Facets, type ManeuverFilters as ApiFilters } from "../api/types";
import { integer, number } from "../lib/urlState";
import type { CampaignView } from "../views";
import { FacetSelect } from "./FacetSelect";
import { FilterInput } from "./FilterInput";
import { SearchIcon } from "./icons";

/** The filters of the campaign page as the API takes them. */
export function apiFilters(view: CampaignView): ApiFilters {
  const fraction = (percent: number | undefined) =>
    percent === undefined ? undefined : percent / 100;
  return {
    search: view.search,
    flight_id: view.flight,
    fta: view.fta,
    min_airspeed_ratio: view.min_ratio,
    max_airspeed_ratio: view.max_ratio,
    min_fuel: fraction(view.min_fuel),
    max_fuel: fraction(view.max_fuel),
    method: view.method,
    state: view.state,
    tag: view.tag,
    deleted: view.deleted,
  };
}

interface Props {
  view: CampaignView;
  choices: Facets["choices"] | undefined;
  onChange: (change: Partial<CampaignView>) => void;
}

export function ManeuverFilters({ view, choices, onChange }: Props) {
  const shown = (value: number | undefined) => (value === undefined ? "" : String(value));
  const range = (
    label: string,
    shownLabel: ReactNode,
    low: "min_ratio" | "min_fuel",
    high: "max_ratio" | "max_fuel",
  ) => (
    <Input.Wrapper label={shownLabel} labelElement="div" size="xs">
      <Group gap={4} wrap="nowrap">
        {([low, high] as const).map((key) => (
          <FilterInput
            key={key}
            w={62}
            inputMode="decimal"
            placeholder={key === low ? "from" : "to"}
            aria-label={`${label} ${key === low ? "from" : "to"}`}
            data-testid={`filter-${key.replace("_", "-")}`}
            value={shown(view[key])}
            onCommit={(value) => {
              onChange({ [key]: number(value.replace(",", ".")) });
            }}
          />
        ))}
      </Group>
    </Input.Wrapper>
  );
  const active = Object.values(apiFilters(view)).some((value) => value !== undefined);

  return (
    <Group gap="sm" align="flex-end" role="search" aria-label="Filter maneuvers">
      <FilterInput
        label="Search"
        placeholder="Label"
        w={150}
        leftSection={<SearchIcon size={12} />}
        data-testid="filter-search"
        value={view.search ?? ""}
        onCommit={(search) => {
          onChange({ search: search === "" ? undefined : search });
        }}
      />
      <FacetSelect
        label="Flight"
        width={88}
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
      {range(
        "V/V_f",
        <>
          V/V<sub>f</sub>
        </>,
        "min_ratio",
        "max_ratio",
      )}
      {range("Fuel in percent", "Fuel [%]", "min_fuel", "max_fuel")}
      <FacetSelect
        label="Method"
        width={96}
        testId="filter-method"
        choices={choices?.method}
        value={view.method}
        onChange={(value) => {
          onChange({ method: METHODS.find((one) => one === value) });
        }}
      />
      <FacetSelect
        label="Run state"
        width={136}
        testId="filter-state"
        choices={choices?.state}
        value={view.state}
        onChange={(value) => {
          onChange({ state: STATES.find((one) => one === value) });
        }}
      />
      <FacetSelect
        label="Tag"
        width={110}
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
            onChange({
              search: undefined,
              flight: undefined,
              fta: undefined,
              min_ratio: undefined,
              max_ratio: undefined,
              min_fuel: undefined,
              max_fuel: undefined,
              method: undefined,
              state: undefined,
              tag: undefined,
              deleted: undefined,
            });
          }}
        >
          Clear
        </Button>
      )}
    </Group>
  );
}

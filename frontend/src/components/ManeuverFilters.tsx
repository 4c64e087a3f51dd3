import { Button, Group, Input, Select } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import type { ReactNode } from "react";
import { flightsQuery } from "../api/queries";
import { METHODS, STATES, type ManeuverFilters as ApiFilters } from "../api/types";
import { integer, number } from "../lib/urlState";
import type { CampaignView } from "../views";
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
  };
}

interface Props {
  view: CampaignView;
  onChange: (change: Partial<CampaignView>) => void;
}

export function ManeuverFilters({ view, onChange }: Props) {
  const flights = useQuery(flightsQuery);
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
      <Select
        label="Flight"
        placeholder="any"
        w={84}
        clearable
        data-testid="filter-flight"
        data={(flights.data ?? []).map((flight) => ({
          value: String(flight.id),
          label: String(flight.number),
        }))}
        value={view.flight === undefined ? null : String(view.flight)}
        onChange={(flight) => {
          onChange({ flight: integer(flight) });
        }}
      />
      <FilterInput
        label="FTA"
        placeholder="any"
        w={62}
        inputMode="numeric"
        data-testid="filter-fta"
        value={shown(view.fta)}
        onCommit={(fta) => {
          onChange({ fta: integer(fta) });
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
      <Select
        label="Method"
        placeholder="any"
        w={84}
        clearable
        data-testid="filter-method"
        data={[...METHODS]}
        value={view.method ?? null}
        onChange={(method) => {
          onChange({ method: METHODS.find((one) => one === method) });
        }}
      />
      <Select
        label="Run state"
        placeholder="any"
        w={112}
        clearable
        data-testid="filter-state"
        data={[...STATES]}
        value={view.state ?? null}
        onChange={(state) => {
          onChange({ state: STATES.find((one) => one === state) });
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
            });
          }}
        >
          Clear
        </Button>
      )}
    </Group>
  );
}

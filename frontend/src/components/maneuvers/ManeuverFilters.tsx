import { Group, Input } from "@mantine/core";
import type { ReactNode } from "react";
import { VERDICTS, type Facets, type ManeuverFilters as ApiFilters } from "../../api/types";
import { number, oneOf } from "../../lib/urlState";
import type { CampaignView } from "../../views";
import { FacetSelect } from "../controls/FacetSelect";
import { FilterInput } from "../controls/FilterInput";
import { ListFilters } from "../controls/ListFilters";

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
    verdict: view.verdict,
    method: view.method,
    state: view.state,
    tag: view.tag,
    deleted: view.deleted,
  };
}

const FILTERS = [
  "search",
  "flight",
  "fta",
  "min_ratio",
  "max_ratio",
  "min_fuel",
  "max_fuel",
  "verdict",
  "method",
  "state",
  "tag",
  "deleted",
] as const satisfies readonly (keyof CampaignView)[];

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
  const cleared = Object.fromEntries(FILTERS.map((key) => [key, undefined]));
  const active = FILTERS.some((key) => view[key] !== undefined);
  return (
    <ListFilters
      records="maneuvers"
      hint="Label"
      view={view}
      choices={choices}
      onChange={onChange}
      onClear={
        active
          ? () => {
              onChange(cleared);
            }
          : undefined
      }
    >
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
        label="Quality"
        width={128}
        testId="filter-verdict"
        choices={choices?.verdict}
        value={view.verdict}
        onChange={(value) => {
          onChange({ verdict: oneOf(value, VERDICTS) });
        }}
      />
    </ListFilters>
  );
}

import { screen, within } from "@testing-library/react";
import userEvent from "@testing-library/user-event";
import { expect, it, vi } from "vitest";
import type { ManeuverItem } from "../../api/types";
import { show } from "../../test/render";
import { ManeuverList } from "./ManeuverList";

const maneuver = (id: number, more: Partial<ManeuverItem> = {}): ManeuverItem => ({
  id,
  label: `M${id}`,
  flight_id: 1,
  flight_number: 17,
  aircraft_id: 1,
  aircraft_name: "FLEX-28",
  fta: 506,
  axis: "longitudinal",
  duration_s: 44,
  airspeed_m_s: 24.56,
  dynamic_pressure_pa: 330,
  airspeed_ratio: 0.65,
  fuel_fraction: 0.5,
  max_input_correlation: 0.042,
  n_runs: 1,
  runs: { OE: { id: 8, state: "failed" }, FRE: null, EE: null },
  tags: [],
  verdict: "good",
  summary: null,
  figures: null,
  deleted_at: null,
  created_at: "2026-03-04T10:00:00Z",
  ...more,
});

const list = (onSelect = vi.fn(), onSort = vi.fn(), sort = "id") => (
  <ManeuverList
    maneuvers={[maneuver(1), maneuver(2, { airspeed_ratio: null, runs: {}, n_runs: 0 })]}
    selected={[1]}
    onSelect={onSelect}
    sort={sort}
    onSort={onSort}
  />
);

it("leads to a maneuver and to its runs", async () => {
  await show(list());
  const row = within(screen.getByTestId("maneuver-row-1"));
  expect(row.getByRole("link", { name: "M1" })).toHaveAttribute("href", "/maneuvers/1");
  expect(row.getByRole("link", { name: "OE run 8, failed" })).toHaveAttribute("href", "/runs/8");
  expect(row.getByText("0.650")).toBeInTheDocument();
  expect(within(screen.getByTestId("maneuver-row-2")).getByText("none")).toBeInTheDocument();
});

it("sorts on the server, by a click on the header and back", async () => {
  const onSort = vi.fn();
  await show(list(vi.fn(), onSort, "fuel_fraction"));
  expect(screen.getByRole("columnheader", { name: /Fuel/ })).toHaveAttribute(
    "aria-sort",
    "ascending",
  );
  await userEvent.click(screen.getByRole("button", { name: /Fuel/ }));
  expect(onSort).toHaveBeenCalledWith("-fuel_fraction");
});

it("selects rows", async () => {
  const onSelect = vi.fn();
  await show(list(onSelect));
  await userEvent.click(screen.getByRole("checkbox", { name: "Select M2" }));
  expect(onSelect).toHaveBeenLastCalledWith([1, 2]);
  await userEvent.click(screen.getByRole("checkbox", { name: "Select M1" }));
  expect(onSelect).toHaveBeenLastCalledWith([]);
});

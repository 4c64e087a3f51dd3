import { Menu, Tooltip, UnstyledButton } from "@mantine/core";
import { useNavigate } from "@tanstack/react-router";
import { useSetUnits } from "../../api/commands";
import { FREQUENCY_UNITS, UNIT_SYSTEMS, type DisplayUnits } from "../../api/types";
import { useDisplayUnits, usePreferredUnits } from "../../api/units";

const NAMES: Record<DisplayUnits["units"], string> = {
  metric: "Metric: m, m/s, Pa, kg, deg, g",
  us: "US: ft, kt, psf, slug, deg, g",
  si: "SI: m, m/s, Pa, kg, rad, m/s²",
};
const SHORT: Record<DisplayUnits["units"], string> = { metric: "Metric", us: "US", si: "SI" };

/** Units of figures, tables and reports: of the user, or of this address alone. */
export function UnitMenu() {
  const shown = useDisplayUnits();
  const preferred = usePreferredUnits();
  const set = useSetUnits();
  const navigate = useNavigate();
  const isOwn =
    shown.units === preferred.units && shown.frequency_unit === preferred.frequency_unit;
  const write = (units: Partial<DisplayUnits>) =>
    void navigate({
      to: ".",
      search: (previous: object) => ({
        ...previous,
        units: undefined,
        frequency_unit: undefined,
        ...units,
      }),
      replace: true,
    });
  const choose = (part: Partial<DisplayUnits>) => {
    set.mutate({ ...shown, ...part });
    if (!isOwn) write({});
  };
  return (
    <Menu position="bottom-end" withinPortal>
      <Menu.Target>
        <Tooltip label="Units of figures, tables and reports">
          <UnstyledButton
            className="frame-find"
            data-testid="units"
            aria-label={`Units: ${SHORT[shown.units]}, ${shown.frequency_unit}`}
          >
            {SHORT[shown.units]}, {shown.frequency_unit}
          </UnstyledButton>
        </Tooltip>
      </Menu.Target>
      <Menu.Dropdown>
        <Menu.Label>Units</Menu.Label>
        {UNIT_SYSTEMS.map((units) => (
          <Menu.Item
            key={units}
            className="frame-item"
            data-current={shown.units === units || undefined}
            data-testid={`units-${units}`}
            onClick={() => {
              choose({ units });
            }}
          >
            {NAMES[units]}
          </Menu.Item>
        ))}
        <Menu.Label>Frequencies</Menu.Label>
        {FREQUENCY_UNITS.map((unit) => (
          <Menu.Item
            key={unit}
            className="frame-item"
            data-current={shown.frequency_unit === unit || undefined}
            data-testid={`frequency-${unit === "Hz" ? "hz" : "rad"}`}
            onClick={() => {
              choose({ frequency_unit: unit });
            }}
          >
            {unit}
          </Menu.Item>
        ))}
        <Menu.Divider />
        <Menu.Item
          data-testid="units-address"
          onClick={() => {
            write(shown);
          }}
        >
          Put these units into the address
        </Menu.Item>
        {!isOwn && (
          <Menu.Item
            onClick={() => {
              write({});
            }}
          >
            Remove the units of this address
          </Menu.Item>
        )}
      </Menu.Dropdown>
    </Menu>
  );
}

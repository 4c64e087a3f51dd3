import { MultiSelect, Select, Stack, Text } from "@mantine/core";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { maneuverQuery, maneuversQuery } from "../../api/queries";
import { fitsCoefficients } from "../../api/types";
import { overTime } from "../../lib/figures/band";
import { integer } from "../../lib/urlState";
import { Figure } from "../figures/Figure";
import type { RunTabProps } from "./FitTab";
import { WindowBar } from "../maneuvers/WindowBar";

/** The identified model under the recorded inputs of its maneuver, or of another one. */
export function TimeTab({ run, view, onChange }: RunTabProps) {
  const own = useQuery(maneuverQuery(run.maneuver_id));
  const all = useInfiniteQuery(maneuversQuery({}, "id", 500));
  const maneuvers = (all.data?.pages ?? [])
    .flatMap((page) => page.items)
    .filter((one) => one.aircraft_id === own.data?.aircraft_id);
  // Equation error stores coefficients, not outputs: its model has the usual outputs.
  const outputs = fitsCoefficients(run) ? [] : (run.blocks[0]?.outputs ?? []);
  const shared = overTime(view, onChange);
  return (
    <div className="split">
      <Stack gap="sm">
        <Select
          label="Recording"
          description="Maneuver of the aircraft; select another one for validation"
          data={maneuvers.map((one) => ({ value: String(one.id), label: one.label }))}
          value={String(view.against ?? run.maneuver_id)}
          allowDeselect={false}
          searchable
          onChange={(value) => {
            const id = integer(value ?? undefined);
            // Another recording has other times.
            const whole = { from: undefined, to: undefined };
            onChange({ against: id === run.maneuver_id ? undefined : id, ...whole });
          }}
        />
        {outputs.length > 0 && (
          <MultiSelect
            label="Outputs"
            data={outputs}
            value={view.outputs ?? outputs.slice(0, 4)}
            searchable
            onChange={(names) => {
              onChange({ outputs: names.length > 0 ? names : undefined });
            }}
          />
        )}
        <Text size="xs" className="quiet">
          The whole recorded band is compared, also above the fitted band. Beyond flutter the
          bounded response of the closed loop is shown.
        </Text>
      </Stack>
      <div className="panel" style={{ padding: 12 }}>
        <WindowBar
          window={shared.window}
          unit="s"
          onClear={() => {
            shared.onWindow(null);
          }}
          hint="Drag over the figure to zoom; the window stays in the address."
          whole="Whole record"
        />
        <Figure
          kind="time-check"
          title="Recorded and simulated"
          params={{
            run_id: run.id,
            outputs: view.outputs?.join(","),
            maneuver_id: view.against,
          }}
          {...shared}
        />
      </div>
    </div>
  );
}

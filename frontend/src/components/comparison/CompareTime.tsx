import { SegmentedControl, Select, Switch } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { maneuverQuery } from "../../api/queries";
import { overTime } from "../../lib/figures/band";
import type { CompareTabProps } from "./CompareDerivatives";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { Loaded } from "../display/Loaded";
import { Section } from "../display/Section";
import { WindowBar } from "../maneuvers/WindowBar";

/** One output over time: records of all maneuvers with the outputs of all runs and their fit. */
export function CompareTime({ comparison, view, onChange }: CompareTabProps) {
  const [first] = comparison.maneuver_ids;
  const maneuver = useQuery({ ...maneuverQuery(first ?? 0), enabled: first !== undefined });
  const shared = overTime(view, onChange);
  return (
    <Loaded query={maneuver} rows={8}>
      {(flown) => {
        const outputs = flown.channels
          .filter((channel) => channel.role === "output")
          .map((channel) => channel.name);
        if (outputs.length === 0) return <Empty title={`${flown.label} has no outputs`} />;
        const output = outputs.find((one) => one === view.output);
        return (
          <Section
            title="Time"
            note="Recorded and simulated from the start of each maneuver, in order of dynamic pressure; fit = 100 % · (1 − ‖y − ŷ‖ / ‖y − mean y‖)"
            actions={
              <Select
                aria-label="Output"
                placeholder="First output"
                searchable
                clearable
                w={160}
                data={outputs}
                value={output ?? null}
                onChange={(next) => {
                  onChange({ output: next ?? undefined });
                }}
              />
            }
          >
            <SegmentedControl
              aria-label="Arrangement"
              mb="xs"
              data={[
                { value: "rows", label: "One row per maneuver" },
                { value: "overlay", label: "All in one" },
              ]}
              value={view.arrangement ?? "rows"}
              onChange={(value) => {
                onChange({ arrangement: value === "overlay" ? value : undefined });
              }}
            />
            <Switch
              mb="xs"
              label="Every run under the inputs of every maneuver"
              checked={view.every === true}
              onChange={(event) => {
                onChange({ every: event.currentTarget.checked || undefined });
              }}
            />
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
              {...shared}
              kind="time-comparison"
              title="Measured and simulated output"
              params={{
                run_ids: view.runs,
                output,
                maneuver_ids: view.every === true ? comparison.maneuver_ids : undefined,
                arrangement: view.arrangement,
              }}
            />
          </Section>
        );
      }}
    </Loaded>
  );
}

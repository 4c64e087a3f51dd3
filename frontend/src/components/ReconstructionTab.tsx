import { MultiSelect, SegmentedControl, Stack, Text, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { figureQuery } from "../api/queries";
import { integers } from "../lib/urlState";
import { axisNames } from "../lib/derivatives";
import { fixed } from "../lib/format";
import { overFrequency, overTime } from "../lib/band";
import { BandBar } from "./BandBar";
import { Figure } from "./Figure";
import { WindowBar } from "./WindowBar";
import type { ManeuverTabProps } from "./TimeHistoryTab";

interface Meta {
  offered?: string[];
  modes?: number[];
  mode_names?: string[];
  n_motions?: number;
  least_rank?: number;
  worst_condition?: number | null;
  n_sensors?: number;
  excluded?: string[];
}

/** Rigid and modal motion and coefficients reconstructed from all sensors (Fig. 16a). */
export function ReconstructionTab({ maneuver, view, onChange }: ManeuverTabProps) {
  const domain = view.domain ?? "time";
  const params = {
    maneuver_id: maneuver.id,
    quantities: view.quantities,
    modes: view.modes,
    domain,
  };
  const figure = useQuery(figureQuery("reconstruction", params));
  const meta = (figure.data?.layout.meta ?? {}) as Meta;
  const shared = domain === "time" ? overTime(view, onChange) : overFrequency(view, onChange);
  const whole = () => {
    shared.onWindow(null);
  };
  const first = meta.modes?.[0];
  const force = axisNames(maneuver.axis).coefficients[0] ?? "CZ";
  const selected = view.quantities ?? (first === undefined ? [force] : [force, `etaddot${first}`]);
  return (
    <div className="split">
      <Stack gap="md">
        <SegmentedControl
          aria-label="Domain"
          data={[
            { value: "time", label: "Time" },
            { value: "frequency", label: "Frequency" },
          ]}
          value={domain}
          onChange={(value) => {
            onChange({ domain: value === "frequency" ? "frequency" : undefined });
          }}
        />
        <MultiSelect
          label="Quantities"
          data={meta.offered ?? selected}
          value={selected}
          searchable
          maxValues={8}
          onChange={(names) => {
            onChange({ quantities: names.length > 0 ? names : undefined });
          }}
        />
        <TextInput
          label="Modes"
          description="Mode numbers; empty: all significant modes"
          placeholder={meta.modes?.join(", ")}
          defaultValue={view.modes?.join(", ") ?? ""}
          onBlur={(event) => {
            onChange({ modes: integers(event.currentTarget.value) });
          }}
        />
        {meta.n_motions !== undefined && (
          <Text size="xs" className="quiet" data-testid="reconstruction-rank">
            {meta.n_sensors} sensors, {meta.n_motions} motions: α, q and{" "}
            {meta.mode_names?.join(", ")}. Lowest rank {meta.least_rank}, largest condition number{" "}
            {fixed(meta.worst_condition, 0)}.
          </Text>
        )}
        {(meta.excluded ?? []).map((reason) => (
          <Text size="xs" className="quiet" key={reason}>
            {reason}
          </Text>
        ))}
      </Stack>
      <div className="panel" style={{ padding: 12 }}>
        {domain === "time" ? (
          <WindowBar
            window={shared.window}
            unit="s"
            onClear={whole}
            hint="Drag over a figure to zoom; time histories share the window."
            whole="Whole record"
          />
        ) : (
          <BandBar maneuverId={maneuver.id} window={shared.window} onClear={whole} />
        )}
        <Figure
          kind="reconstruction"
          title={domain === "time" ? "Smoothed by a Kalman filter" : "Reconstruction by frequency"}
          params={params}
          {...shared}
        />
      </div>
    </div>
  );
}

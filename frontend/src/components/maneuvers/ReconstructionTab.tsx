import { MultiSelect, SegmentedControl, Stack, Text, TextInput } from "@mantine/core";
import { reconstructionResult } from "../../api/queries";
import { useStoredResult } from "../../api/useStoredResult";
import { integers } from "../../lib/urlState";
import { axisNames } from "../../lib/derivatives";
import { fixed } from "../../lib/text/format";
import { overFrequency, overTime } from "../../lib/figures/band";
import { AxisPicker } from "../controls/AxisPicker";
import { BandBar } from "./BandBar";
import { ComputeButton } from "../controls/ComputeButton";
import { Figure } from "../figures/Figure";
import { JobWait } from "../jobs/JobWait";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";
import { asAxis } from "../new-run/runRequest";
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
  const axis = view.axis ?? asAxis(maneuver.axis);
  const { coefficients, motions } = axisNames(axis);
  const params = {
    maneuver_id: maneuver.id,
    quantities: view.quantities,
    modes: view.modes,
    axis: axis === maneuver.axis ? undefined : axis,
    domain,
  };
  const stored = reconstructionResult(maneuver.id, view.modes, params.axis);
  const { result, jobId, error, onEnd, compute } = useStoredResult(stored);
  const meta = (result.data?.layout.meta ?? {}) as Meta;
  const shared = domain === "time" ? overTime(view, onChange) : overFrequency(view, onChange);
  const whole = () => {
    shared.onWindow(null);
  };
  const first = meta.modes?.[0];
  const force = coefficients[0] ?? "CZ";
  const selected = view.quantities ?? (first === undefined ? [force] : [force, `etaddot${first}`]);
  return (
    <div className="split">
      <Stack gap="md">
        <AxisPicker
          maneuver={maneuver.axis}
          value={axis}
          onChange={(next) => {
            onChange({ axis: next, quantities: undefined, modes: undefined });
          }}
        />
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
          key={axis}
          defaultValue={view.modes?.join(", ") ?? ""}
          onBlur={(event) => {
            onChange({ modes: integers(event.currentTarget.value) });
          }}
          onKeyDown={(event) => {
            if (event.key === "Enter") event.currentTarget.blur();
          }}
        />
        {meta.n_motions !== undefined && (
          <Text size="xs" className="quiet" data-testid="reconstruction-rank">
            {meta.n_sensors} sensors, {meta.n_motions} motions:{" "}
            {[...motions, ...(meta.mode_names ?? [])].join(", ")}. Lowest rank {meta.least_rank},
            largest condition number {fixed(meta.worst_condition, 0)}.
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
        <ComputeButton compute={compute} />
        {error !== null && <ProblemAlert error={error} />}
        {jobId !== undefined && <JobWait key={jobId} id={jobId} onEnd={onEnd} />}
        {compute === undefined && jobId === undefined && error === null && (
          <Loaded query={result} rows={12}>
            {() => (
              <Figure
                kind="reconstruction"
                title={
                  domain === "time" ? "Smoothed by a Kalman filter" : "Reconstruction by frequency"
                }
                params={params}
                {...shared}
              />
            )}
          </Loaded>
        )}
      </div>
    </div>
  );
}

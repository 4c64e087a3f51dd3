import { Alert, Stack, Text } from "@mantine/core";
import { storedResult } from "../../api/storedResult";
import type { OutputOnlyResult } from "../../api/types";
import { overFrequency } from "../../lib/figures/band";
import { fixed, withError } from "../../lib/text/format";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { NumberField } from "../controls/NumberField";
import { ComputedResult } from "../display/ComputedResult";
import { Figure } from "../figures/Figure";
import type { ManeuverTabProps } from "./TimeHistoryTab";
import { WindowBar } from "./WindowBar";

type Mode = OutputOnlyResult["modes"][number];

const COLUMNS: Column<Mode>[] = [
  { key: "name", header: "Mode", render: (one) => one.name || "Not in the modal table" },
  numeric(
    "frequency",
    "Frequency [Hz]",
    (one) => withError(one.frequency_hz, one.frequency_std_hz).value,
  ),
  numeric("frequency_std", "σ", (one) => withError(one.frequency_hz, one.frequency_std_hz).error),
  numeric(
    "damping",
    "Damping ratio [%]",
    (one) => withError(100 * one.damping, 100 * one.damping_std).value,
  ),
  numeric(
    "damping_std",
    "σ [%]",
    (one) => withError(100 * one.damping, 100 * one.damping_std).error,
  ),
  numeric("mac", "MAC", (one) => (one.mac === null ? "" : fixed(one.mac, 2))),
];

/** Modes from the outputs alone, as in turbulence: of the record or the part that is selected. */
export function OutputOnlyTab({ maneuver, view, onChange }: ManeuverTabProps) {
  const shared = overFrequency(view, onChange);
  const params = {
    maneuver_id: maneuver.id,
    low_hz: shared.window?.[0],
    high_hz: shared.window?.[1],
    start_s: view.from,
    stop_s: view.to,
  };
  return (
    <div className="split">
      <Stack gap="md">
        <NumberField
          label="Begin [s]"
          description="Of the part that is used"
          placeholder="Begin of the record"
          value={view.from}
          onChange={(from) => {
            onChange({ from });
          }}
        />
        <NumberField
          label="End [s]"
          placeholder="End of the record"
          value={view.to}
          onChange={(to) => {
            onChange({ to });
          }}
        />
      </Stack>
      <div className="panel" style={{ padding: 12 }}>
        <WindowBar
          window={shared.window}
          unit="Hz"
          onClear={() => {
            shared.onWindow(null);
          }}
          hint="From 1 Hz to 0.4 of the sample rate. Drag over the figure to select a band."
          whole="The usual band"
        />
        <ComputedResult
          options={storedResult("/api/v1/output-only-modes", { query: params })}
          rows={8}
        >
          {(found) => (
            <Stack gap="sm">
              {found.warnings.map((warning) => (
                <Alert key={warning} color="yellow" variant="light" title={warning} />
              ))}
              <Text size="sm" className="quiet" data-testid="output-only">
                {`${String(found.modes.length)} ${found.modes.length === 1 ? "mode" : "modes"} from ${String(found.outputs.length)} outputs over ${fixed(found.duration_s, 0)} s`}
                {found.tones_hz.length > 0 &&
                  `; tones left out: ${found.tones_hz.map((one) => fixed(one, 2)).join(", ")} Hz`}
              </Text>
              <DataTable
                label="Modes from the outputs alone"
                columns={COLUMNS}
                rows={found.modes}
                rowKey={(one) => String(one.frequency_hz)}
              />
              <Figure
                kind="output-only-modes"
                title="Spectral density with the fitted model, and damping with ±2σ"
                params={params}
                {...shared}
              />
            </Stack>
          )}
        </ComputedResult>
      </div>
    </div>
  );
}

import { Stack, Switch } from "@mantine/core";
import { excitedInputs, offeredChannels } from "../../lib/channels";
import { bandOf, overFrequency, windowOf } from "../../lib/figures/band";
import { BandBar } from "./BandBar";
import { ChannelPicker } from "../controls/ChannelPicker";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import type { ManeuverTabProps } from "./TimeHistoryTab";

/** Fourier magnitudes, colored by the excited input of each harmonic. */
export function SpectraTab({ maneuver, view, onChange }: ManeuverTabProps) {
  const inputs = excitedInputs(maneuver).slice(0, 1);
  const channels =
    view.channels ??
    [...inputs, "q", "az_egi"].filter((name) =>
      maneuver.channels.some((channel) => channel.name === name),
    );
  return (
    <div className="split">
      <Stack gap="md">
        <Switch
          label="Whole spectrum"
          description="Up to the Nyquist frequency, with the modelled band shaded"
          checked={view.full === true}
          onChange={(event) => {
            onChange({ full: event.currentTarget.checked || undefined });
          }}
        />
        <ChannelPicker
          label="Channels"
          groups={offeredChannels(maneuver)}
          value={channels}
          onChange={(names) => {
            onChange({ channels: names });
          }}
        />
      </Stack>
      <div className="panel" style={{ padding: 12 }}>
        {channels.length === 0 ? (
          <Empty title="No channel selected">Select one or more on the left.</Empty>
        ) : (
          <>
            <BandBar
              maneuverId={maneuver.id}
              window={windowOf(view)}
              onClear={() => {
                onChange(bandOf(null));
              }}
            />
            <Figure
              kind="spectrum"
              title="Fourier magnitudes by excited input"
              params={{ maneuver_id: maneuver.id, channels, full: view.full }}
              revision={`${channels.join()} ${String(view.full)}`}
              {...overFrequency(view, onChange)}
            />
          </>
        )}
      </div>
    </div>
  );
}

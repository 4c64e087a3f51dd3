import type { Maneuver } from "../../api/types";
import { firstLook, offeredChannels } from "../../lib/channels";
import type { ManeuverView } from "../../views";
import { ChannelPicker } from "../controls/ChannelPicker";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";

export interface ManeuverTabProps {
  maneuver: Maneuver;
  view: ManeuverView;
  onChange: (change: Partial<ManeuverView>) => void;
}

/** Channels against time; zooming asks the server for the finer samples of the window. */
export function TimeHistoryTab({ maneuver, view, onChange }: ManeuverTabProps) {
  const channels = view.channels ?? firstLook(maneuver.default_channels);
  return (
    <div className="split">
      <ChannelPicker
        label="Channels"
        groups={offeredChannels(maneuver)}
        value={channels}
        onChange={(names) => {
          onChange({ channels: names });
        }}
      />
      <div className="panel" style={{ padding: 12 }}>
        {channels.length === 0 ? (
          <Empty title="No channel selected">Select one or more on the left.</Empty>
        ) : (
          <Figure
            kind="time-history"
            title="Time histories"
            params={{
              maneuver_id: maneuver.id,
              channels,
              start_s: view.from,
              stop_s: view.to,
              points: 2000,
            }}
            revision={[channels, view.from, view.to].join()}
            onWindow={(window) => {
              onChange({ from: window?.[0], to: window?.[1] });
            }}
          />
        )}
      </div>
    </div>
  );
}

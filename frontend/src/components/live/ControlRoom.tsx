import { Button, Popover } from "@mantine/core";
import type { ReactNode } from "react";
import type { LiveState, Reception, StreamChannel } from "../../api/types";
import { byRole } from "../../lib/channels";
import type { Samples } from "../../lib/live/samples";
import { ChannelPicker } from "../controls/ChannelPicker";
import { Empty } from "../display/Empty";
import { Section } from "../display/Section";
import { DataHealth } from "./DataHealth";
import { FlutterMargin } from "./FlutterMargin";
import { LiveDerivatives } from "./LiveDerivatives";
import { LiveModes } from "./LiveModes";
import { StripCharts } from "./StripCharts";

interface Props {
  channels: readonly StreamChannel[];
  /** Names of the channels with a strip chart. */
  shown: readonly string[];
  onShown: (names: string[]) => void;
  limits: Readonly<Record<string, readonly number[]>>;
  next_m_s: number | null;
  expected: Readonly<Record<string, number | null>>;
  samples: Samples;
  /** States of the present maneuver, oldest first. */
  states: readonly LiveState[];
  receiver: Reception | null;
  hasEnded: boolean;
  /** Frequency response, below the data. */
  bode: ReactNode;
  /** Below the strip charts. */
  children: ReactNode;
}

/** Strip charts at the left; what is identified from them at the right. */
export function ControlRoom({
  channels,
  shown,
  onShown,
  samples,
  states,
  hasEnded,
  bode,
  ...props
}: Props) {
  const state = states.at(-1) ?? null;
  const estimate = state?.estimate ?? null;
  return (
    <div className="live">
      <div className="stack">
        <Section
          title="Strip charts"
          note="Last 30 s over the time of the recorder [s]"
          actions={
            <Popover position="bottom-end" trapFocus returnFocus>
              <Popover.Target>
                <Button variant="default" data-testid="channels">
                  Channels
                </Button>
              </Popover.Target>
              <Popover.Dropdown w={300}>
                <ChannelPicker
                  label="Channels"
                  groups={byRole(channels)}
                  value={[...shown]}
                  onChange={onShown}
                  height={360}
                />
              </Popover.Dropdown>
            </Popover>
          }
        >
          {hasEnded ? (
            <Empty title="The stream has ended">
              Samples are those of the stored maneuvers under <em>Test points</em>.
            </Empty>
          ) : (
            <StripCharts
              channels={channels.filter((channel) => shown.includes(channel.name))}
              samples={samples}
              limits={props.limits}
              state={state}
            />
          )}
        </Section>
        <DataHealth state={state} receiver={props.receiver} />
        {bode}
        {props.children}
      </div>
      <div className="stack">
        <FlutterMargin estimate={estimate} next_m_s={props.next_m_s} />
        <LiveModes
          states={states}
          modes={estimate?.modes ?? []}
          recent={estimate?.recent_modes ?? []}
          reason={state?.reason ?? ""}
        />
        <LiveDerivatives estimate={estimate} expected={props.expected} />
      </div>
    </div>
  );
}

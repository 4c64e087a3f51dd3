import { Text } from "@mantine/core";
import type { LiveState, Reception } from "../../api/types";
import { count } from "../../lib/text/format";
import { describeHealth, describeReception } from "../../lib/live/health";
import { Section } from "../display/Section";

interface Props {
  state: LiveState | null;
  /** Connection and messages of the receiver. */
  receiver: Reception | null;
}

/** The receiver, lost and late frames, and channels with defects, in the present maneuver. */
export function DataHealth({ state, receiver }: Props) {
  const defects = state?.health ?? [];
  return (
    <Section title="Data">
      {receiver !== null && (
        <ul className="links" data-testid="live-receiver">
          {describeReception(receiver).map((part) => (
            <li key={part}>{receiver.is_connected === false ? <strong>{part}</strong> : part}</li>
          ))}
        </ul>
      )}
      <Text size="md" className="numbers" data-testid="live-frames">
        {state === null
          ? "No data yet."
          : `${count(state.lost_frames, "frame")} lost, ${count(state.late_frames, "frame")} late.`}
      </Text>
      {state !== null && (
        <ul className="links" data-testid="live-health">
          {defects.map((health) => (
            <li key={health.name}>
              <strong>{health.name}</strong>: {describeHealth(health)}
            </li>
          ))}
          {defects.length === 0 && <li>All channels without defects.</li>}
        </ul>
      )}
    </Section>
  );
}

import { Text } from "@mantine/core";
import type { LiveState } from "../../api/types";
import { count } from "../../lib/format";
import { describeHealth } from "../../lib/live/health";
import { Section } from "../Section";

/** Lost and late frames, and channels with defects, in the present maneuver. */
export function DataHealth({ state }: { state: LiveState | null }) {
  const defects = state?.health ?? [];
  return (
    <Section title="Data">
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

import { Group, Select } from "@mantine/core";
import { useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { Section } from "../display/Section";

interface Props {
  streamId: number;
  outputs: readonly string[];
  inputs: readonly string[];
  output: string | undefined;
  input: string | undefined;
  onChange: (change: { output?: string; input?: string }) => void;
  /** End of the record of the newest estimate, null before the first. [s] */
  time_s: number | null;
  hasEnded: boolean;
}

/** Frequency response of one output and input, which fills in while the maneuver is flown. */
export function LiveBode({ streamId, outputs, inputs, time_s, hasEnded, ...props }: Props) {
  const cache = useQueryClient();
  const output = props.output ?? outputs[0];
  const input = props.input ?? inputs[0];
  useEffect(() => {
    if (time_s !== null) void cache.invalidateQueries({ queryKey: ["figure", "live-bode"] });
  }, [cache, time_s]);
  return (
    <Section
      title="Frequency response"
      note="Record so far ± 2 standard errors, and the model of the latest estimate"
    >
      {hasEnded || output === undefined || input === undefined ? (
        <Empty title="The stream has ended">
          Frequency responses are those of the stored maneuvers under <em>Test points</em>.
        </Empty>
      ) : (
        <>
          <Group gap="xs" grow mb="xs">
            <Select
              label="Output"
              searchable
              allowDeselect={false}
              data={[...outputs]}
              value={output}
              onChange={(name) => {
                props.onChange({ output: name ?? undefined });
              }}
              data-testid="live-bode-output"
            />
            <Select
              label="Input"
              allowDeselect={false}
              data={[...inputs]}
              value={input}
              onChange={(name) => {
                props.onChange({ input: name ?? undefined });
              }}
              data-testid="live-bode-input"
            />
          </Group>
          {time_s === null ? (
            <Empty title="No estimate yet" />
          ) : (
            <Figure
              kind="live-bode"
              params={{ stream_id: streamId, output, input }}
              title={`${output} over ${input}`}
              height={340}
            />
          )}
        </>
      )}
    </Section>
  );
}

import { Button, CloseButton, Group, Select } from "@mantine/core";
import { NumberField } from "../controls/NumberField";

export interface ChannelLimit {
  channel: string;
  /** In the SI unit of the channel. */
  low: number | undefined;
  high: number | undefined;
}

interface Props {
  channels: readonly { name: string; unit: string }[];
  limits: readonly ChannelLimit[];
  onChange: (limits: ChannelLimit[]) => void;
}

/** Lowest and highest value of channels, beyond which there is an alarm, in the unit of each. */
export function StreamLimits({ channels, limits, onChange }: Props) {
  const set = (index: number, change: Partial<ChannelLimit>) => {
    onChange(limits.map((limit, at) => (at === index ? { ...limit, ...change } : limit)));
  };
  const free = channels.filter(({ name }) => !limits.some((limit) => limit.channel === name));
  return (
    <>
      {limits.map((limit, index) => {
        const unit = channels.find(({ name }) => name === limit.channel)?.unit ?? "";
        return (
          <Group key={limit.channel} gap={6} align="end" wrap="nowrap">
            <Select
              label="Limits of"
              allowDeselect={false}
              searchable
              data={[limit.channel, ...free.map(({ name }) => name)]}
              value={limit.channel}
              onChange={(channel) => {
                if (channel !== null) set(index, { channel });
              }}
            />
            <NumberField
              label="Low"
              unit={unit}
              required
              value={limit.low}
              onChange={(low) => {
                set(index, { low });
              }}
            />
            <NumberField
              label="High"
              unit={unit}
              required
              value={limit.high}
              onChange={(high) => {
                set(index, { high });
              }}
            />
            <CloseButton
              aria-label={`Remove the limits of ${limit.channel}`}
              onClick={() => {
                onChange(limits.filter((_, at) => at !== index));
              }}
            />
          </Group>
        );
      })}
      <Button
        variant="default"
        disabled={free.length === 0}
        data-testid="add-limit"
        onClick={() => {
          const [one] = free;
          if (one !== undefined)
            onChange([...limits, { channel: one.name, low: undefined, high: undefined }]);
        }}
      >
        Add limits of a channel
      </Button>
    </>
  );
}

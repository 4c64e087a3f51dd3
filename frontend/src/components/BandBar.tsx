import { Button, Group, Text } from "@mantine/core";
import { significant } from "../lib/format";
import { ButtonLink } from "./ButtonLink";

interface Props {
  maneuverId: number;
  window: [number, number] | undefined;
  onClear: () => void;
  /** Run whose choices a run in this band begins with. */
  like?: number;
}

/** The band that was brushed: fit it, or see everything again. */
export function BandBar({ maneuverId, window, onClear, like }: Props) {
  if (window === undefined) {
    return (
      <Text size="xs" className="quiet" mb={4}>
        Drag over a figure to choose a band; spectra, responses and fits share it.
      </Text>
    );
  }
  const [low, high] = window;
  return (
    <Group gap="xs" mb={4} data-testid="band-bar">
      <Text size="sm" className="numbers">
        {significant(low, 3)} to {significant(high, 3)} Hz
      </Text>
      <ButtonLink
        size="compact-xs"
        to="/maneuvers/$id/new-run"
        params={{ id: maneuverId }}
        search={{ low, high, like }}
        data-testid="run-band"
      >
        New run in this band
      </ButtonLink>
      <Button variant="subtle" size="compact-xs" onClick={onClear}>
        Whole band
      </Button>
    </Group>
  );
}

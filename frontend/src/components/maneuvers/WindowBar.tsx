import { Button, Group, Text } from "@mantine/core";
import type { ReactNode } from "react";
import { useConversion } from "../../api/units";
import { significant } from "../../lib/text/format";

interface Props {
  /** In s or Hz. */
  window: [number, number] | undefined;
  unit: "Hz" | "s";
  onClear: () => void;
  /** What a window is good for, while there is none. */
  hint: string;
  /** What is shown without a window. */
  whole: string;
  /** What can be done with the window. */
  children?: ReactNode;
}

/** The window that was brushed, which figures share, and the way back to everything. */
export function WindowBar({ window, unit, onClear, hint, whole, children }: Props) {
  const { name, factor } = useConversion()(unit);
  if (window === undefined) {
    return (
      <Text size="xs" className="quiet" mb={4}>
        {hint}
      </Text>
    );
  }
  const digits = unit === "s" ? 5 : 3;
  const [from, to] = window.map((end) => factor * end);
  return (
    <Group gap="xs" mb={4} data-testid="band-bar">
      <Text size="sm" className="numbers">
        {significant(from, digits)} to {significant(to, digits)} {name}
      </Text>
      {children}
      <Button variant="subtle" size="compact-xs" onClick={onClear}>
        {whole}
      </Button>
    </Group>
  );
}

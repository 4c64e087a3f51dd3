import { Button, Group, Text } from "@mantine/core";

/** Button that requests a result after its settings have changed. */
export function ComputeButton({ compute }: { compute: (() => void) | undefined }) {
  if (compute === undefined) return null;
  return (
    <Group className="panel" p="sm" gap="sm">
      <Button data-testid="compute" onClick={compute}>
        Compute
      </Button>
      <Text size="sm" className="quiet">
        Settings have changed.
      </Text>
    </Group>
  );
}

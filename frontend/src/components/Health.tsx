import { Group, Text, Tooltip } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { healthQuery } from "../api/queries";

/** Whether the server answers, and which version it is. */
export function Health() {
  const { data, isError, isPending } = useQuery(healthQuery);
  const color = isError ? "red" : isPending ? "gray" : "teal";
  const label = isError ? "Not reachable, retrying" : isPending ? "Connecting" : data.version;
  return (
    <Tooltip label={isError ? "The server does not answer" : "Server version"}>
      <Group gap={6} wrap="nowrap" role="status" data-testid="health">
        <span
          style={{
            width: 8,
            height: 8,
            borderRadius: 4,
            background: `var(--mantine-color-${color}-6)`,
          }}
        />
        <Text size="xs" className="quiet numbers">
          {label}
        </Text>
      </Group>
    </Tooltip>
  );
}

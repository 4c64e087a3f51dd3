import { Alert, Group, Text, Tooltip } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useRouter } from "@tanstack/react-router";
import { useEffect, useRef } from "react";
import { healthQuery } from "../../api/queries";

/** Connection state and version of the server. */
export function Health() {
  const { data, isError, isPending } = useQuery(healthQuery);
  const degraded = data?.status === "degraded";
  const starting = data?.parts.some((part) => part.state === "starting");
  const color = isError ? "red" : isPending || starting ? "gray" : degraded ? "yellow" : "teal";
  const label = isError
    ? "Reconnecting"
    : isPending
      ? "Connecting"
      : starting
        ? "Starting"
        : data.version;
  return (
    <Tooltip
      label={
        isError
          ? "Server not reachable"
          : starting
            ? "Jobs wait until the dispatcher has started"
            : "Server version"
      }
    >
      <Group gap={6} wrap="nowrap" role="status" data-testid="health">
        <span
          style={{
            width: 8,
            height: 8,
            borderRadius: 4,
            background: `var(--mantine-color-${color}-6)`,
          }}
        />
        <Text size="xs" className="quiet numbers frame-version">
          {label}
        </Text>
      </Group>
    </Tooltip>
  );
}

/** Alert on degraded parts of the workbench, such as missing workers. */
export function Degraded() {
  const { data, isError } = useQuery(healthQuery);
  if (isError || data?.status !== "degraded") return null;
  const parts = data.parts.filter((part) => part.state === "degraded");
  return (
    <Alert
      color="yellow"
      variant="light"
      role="alert"
      mb="md"
      title={`Not working: ${parts.map((part) => part.name).join(", ")}`}
      data-testid="degraded"
    >
      {parts.map((part) => (
        <div key={part.name}>{part.text}</div>
      ))}
    </Alert>
  );
}

/** Alert on a lost connection; failed queries are repeated after the reconnection. */
export function LostConnection() {
  const { isError } = useQuery(healthQuery);
  const cache = useQueryClient();
  const router = useRouter();
  const wasLost = useRef(false);
  useEffect(() => {
    if (wasLost.current && !isError) {
      void cache.invalidateQueries();
      void router.invalidate(); // a page whose code could not be loaded
    }
    wasLost.current = isError;
  }, [isError, cache, router]);
  if (!isError) return null;
  return (
    <Alert
      color="red.9"
      variant="filled"
      role="alert"
      mb="md"
      title="Server not reachable"
      data-testid="lost-connection"
    >
      Displayed data may be out of date. The page reconnects automatically.
    </Alert>
  );
}

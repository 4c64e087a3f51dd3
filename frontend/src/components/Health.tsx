import { Alert, Group, Text, Tooltip } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useRouter } from "@tanstack/react-router";
import { useEffect, useRef } from "react";
import { healthQuery } from "../api/queries";

/** Whether the server answers, and which version it is. */
export function Health() {
  const { data, isError, isPending } = useQuery(healthQuery);
  const degraded = data?.status === "degraded";
  const color = isError ? "red" : isPending ? "gray" : degraded ? "yellow" : "teal";
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

/** What of the workbench is not well: nobody computes, or the clock is behind. */
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

/** Says that the server is lost; once it answers again, what failed is asked again. */
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
      title="The server does not answer"
      data-testid="lost-connection"
    >
      What is shown may be out of date. This page tries again by itself and goes on where it was.
    </Alert>
  );
}

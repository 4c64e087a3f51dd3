import { Skeleton, Stack } from "@mantine/core";
import type { UseQueryResult } from "@tanstack/react-query";
import type { ReactNode } from "react";
import { ProblemAlert } from "./ProblemAlert";

interface Props<T> {
  query: Pick<UseQueryResult<T>, "data" | "error" | "isError" | "refetch">;
  /** Rows of the grey stand-in while loading. */
  rows?: number;
  children: (data: T) => ReactNode;
}

/** The three states of whatever is fetched: loading, failed, there. */
export function Loaded<T>({ query, rows = 4, children }: Props<T>) {
  // Data that was fetched before stays when a later refresh fails; the frame says so.
  if (query.data !== undefined) return <>{children(query.data)}</>;
  if (query.isError) {
    return <ProblemAlert error={query.error} onRetry={() => void query.refetch()} />;
  }
  return (
    <Stack gap="xs" aria-busy="true" aria-label="Loading">
      {Array.from({ length: rows }, (_, row) => (
        <Skeleton key={row} height={22} radius="sm" />
      ))}
    </Stack>
  );
}

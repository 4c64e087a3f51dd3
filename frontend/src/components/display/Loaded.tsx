import { Skeleton, Stack } from "@mantine/core";
import type { UseQueryResult } from "@tanstack/react-query";
import type { ReactNode } from "react";
import { PageHead } from "../frame/PageHead";
import { ProblemAlert } from "./ProblemAlert";

interface Props<T> {
  query: Pick<UseQueryResult<T>, "data" | "error" | "isError" | "refetch">;
  /** Rows of the grey stand-in while loading. */
  rows?: number;
  /** Title of the page that this is all of, until what was fetched heads it. */
  page?: string;
  children: (data: T) => ReactNode;
}

/** Content of a query: loading, failed or fetched. */
export function Loaded<T>({ query, rows = 4, page, children }: Props<T>) {
  // Data fetched before remain when a later refresh fails; the frame reports it.
  if (query.data !== undefined) return <>{children(query.data)}</>;
  const head = page !== undefined && <PageHead title={page} />;
  if (query.isError) {
    return (
      <>
        {head}
        <ProblemAlert error={query.error} onRetry={() => void query.refetch()} />
      </>
    );
  }
  return (
    <>
      {head}
      <Stack gap="xs" role="status" aria-busy="true" aria-label="Loading">
        {Array.from({ length: rows }, (_, row) => (
          <Skeleton key={row} height={22} radius="sm" />
        ))}
      </Stack>
    </>
  );
}

import type { ReactNode } from "react";
import { useStoredResult, type StoredResultOptions } from "../../api/useStoredResult";
import { ComputeButton } from "../controls/ComputeButton";
import { JobWait } from "../jobs/JobWait";
import { Loaded } from "./Loaded";
import { ProblemAlert } from "./ProblemAlert";

interface Props<T> {
  options: StoredResultOptions<T>;
  /** Rows of the grey stand-in while loading. */
  rows?: number;
  children: (data: T) => ReactNode;
}

/** A result that the server computes as a job: the job until it has ended, then the result. */
export function ComputedResult<T>({ options, rows, children }: Props<T>) {
  const { result, jobId, error, onEnd, compute } = useStoredResult(options);
  if (compute !== undefined) return <ComputeButton compute={compute} />;
  if (error !== null) return <ProblemAlert error={error} />;
  if (jobId !== undefined) return <JobWait key={jobId} id={jobId} onEnd={onEnd} />;
  return (
    <Loaded query={result} rows={rows}>
      {children}
    </Loaded>
  );
}

import { METHODS, MODEL_AXES } from "../../api/types";

/** The newest succeeded run of each axis and method, in the order of the methods. */
export function latestPerMethod<
  R extends { id: number; axis: string; method: string; state: string },
>(runs: readonly R[]): R[] {
  const succeeded = runs.filter((run) => run.state === "succeeded").sort((a, b) => b.id - a.id);
  return MODEL_AXES.flatMap((axis) =>
    METHODS.flatMap(
      (method) => succeeded.find((run) => run.axis === axis && run.method === method) ?? [],
    ),
  );
}

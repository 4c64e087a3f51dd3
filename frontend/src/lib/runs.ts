/** The newest succeeded run of each axis and method, in the order of the methods. */
export function latestPerMethod<
  R extends { id: number; axis: string; method: string; state: string },
>(runs: readonly R[]): R[] {
  const succeeded = runs.filter((run) => run.state === "succeeded").sort((a, b) => b.id - a.id);
  return ["longitudinal", "lateral"].flatMap((axis) =>
    ["OE", "FRE", "EE"].flatMap(
      (method) => succeeded.find((run) => run.axis === axis && run.method === method) ?? [],
    ),
  );
}

/** The newest succeeded run of each method, in the order of the methods. */
export function latestPerMethod<R extends { id: number; method: string; state: string }>(
  runs: readonly R[],
): R[] {
  const succeeded = runs.filter((run) => run.state === "succeeded").sort((a, b) => b.id - a.id);
  return ["OE", "FRE", "EE"].flatMap(
    (method) => succeeded.find((run) => run.method === method) ?? [],
  );
}

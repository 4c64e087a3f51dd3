/** Where a job leads to: the address of its kind, with the values of its request and result. */
type Values = Record<string, unknown>;

interface Subject {
  id: number;
  request: Values | null;
  result: Values | null;
}

/**
 * Fill the address of a kind; null where a value in its path is missing.
 *
 * Search parameters without value are left out. `{runs}` is a value of the request,
 * `{result.id}` of the result, `{id}` the job; `{fuel:percent}` and `{delay:not}` change it.
 */
export function jobAddress(page: string, job: Subject): string | null {
  const [address = "", hash] = page.split("#");
  const [path = "", search = ""] = address.split("?");
  let complete = page !== "";
  const filled = path.replaceAll(/\{([^}]+)\}/g, (_, name: string) => {
    const value = Array.isArray(find(job, name))
      ? (find(job, name) as unknown[])[0]
      : find(job, name);
    if (written(value) === "") complete = false;
    return written(value);
  });
  const pairs = search.split("&").flatMap((pair) => {
    const text = pair.replaceAll(/\{([^}]+)\}/g, (_, name: string) => written(find(job, name)));
    return text === "" || text.endsWith("=") ? [] : [text];
  });
  if (!complete) return null;
  const query = pairs.length > 0 ? `?${pairs.join("&")}` : "";
  return filled + query + (hash === undefined ? "" : `#${hash}`);
}

function find(job: Subject, name: string): unknown {
  const [path = "", change] = name.split(":");
  if (path === "id") return job.id;
  const from = path.startsWith("result.") ? job.result : job.request;
  const keys = path.replace("result.", "").split(".");
  const value = keys.reduce<unknown>((at, key) => (at as Values | null | undefined)?.[key], from);
  if (change === "not") return value === false ? true : undefined;
  if (change === "percent")
    return typeof value === "number" ? Number((100 * value).toPrecision(12)) : undefined;
  return value;
}

function written(value: unknown): string {
  if (Array.isArray(value)) return value.map(written).join(",");
  if (typeof value === "string") return encodeURIComponent(value);
  return typeof value === "number" || value === true ? String(value) : "";
}

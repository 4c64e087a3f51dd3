/** Error responses of the API (RFC 9457 problem details). */
export class ApiProblem extends Error {
  override readonly name = "ApiProblem";

  constructor(
    readonly title: string,
    readonly detail: string,
    readonly code: string,
    readonly status: number,
    /** Further members of the problem, such as the row and column of a bad file. */
    readonly context: Record<string, string | number> = {},
    /** The whole problem, for pages that offer a resolution. */
    readonly body: unknown = null,
  ) {
    super(detail || title);
  }
}

const STANDARD = new Set(["type", "title", "status", "detail", "code", "instance"]);

export function problemFrom(body: unknown, status: number): ApiProblem {
  if (typeof body !== "object" || body === null || !("title" in body)) {
    return new ApiProblem(
      "Server error",
      `Status ${status} without details. See the server log.`,
      "unexplained",
      status,
    );
  }
  const members = body as Record<string, unknown>;
  const text = (key: string) => (typeof members[key] === "string" ? members[key] : "");
  const context: Record<string, string | number> = {};
  for (const [key, value] of Object.entries(members)) {
    if (STANDARD.has(key)) continue;
    if (typeof value === "string" || typeof value === "number") context[key] = value;
  }
  return new ApiProblem(text("title"), text("detail"), text("code"), status, context, body);
}

export function unreachable(): ApiProblem {
  return new ApiProblem(
    "Server not reachable",
    "No response from flexsid. It may be starting or stopped; the page retries automatically.",
    "unreachable",
    0,
  );
}

/** Any thrown value as a problem that can be shown. */
export function asProblem(error: unknown): ApiProblem {
  if (error instanceof ApiProblem) return error;
  const detail = error instanceof Error ? error.message : String(error);
  return new ApiProblem("Page error", detail, "page", 0);
}

/** Edits to a mapping as TOML text, so that its comments and order stay. */

const CONDITION = "maneuver.condition";
const CONDITIONS = [
  ...["airspeed", "altitude", "density", "fuel_fraction", "mass"],
  ...["roll_inertia", "pitch_inertia", "yaw_inertia"],
];

/** Lines of the nth table of a name, or of the top: from after its header to the next header. */
function block(lines: string[], table: string, nth: number): [number, number] | null {
  if (table === "") {
    const first = lines.findIndex((line) => /^\s*\[/.test(line));
    return [0, first < 0 ? lines.length : first];
  }
  const headers = [`[[${table}]]`, `[${table}]`];
  let seen = -1;
  for (const [at, line] of lines.entries()) {
    if (!headers.includes(bare(line))) continue;
    seen += 1;
    if (seen !== nth) continue;
    const rest = lines.slice(at + 1);
    const next = rest.findIndex((other) => /^\s*\[/.test(other));
    return [at + 1, next < 0 ? lines.length : at + 1 + next];
  }
  return null;
}

function bare(line: string): string {
  return line.replace(/#.*$/, "").replaceAll(/\s/g, "");
}

const isKey = (line: string, key: string) => new RegExp(`^\\s*"?${key}"?\\s*=`).test(line);

/** Set a key of the nth table of a name, which confirms it; undefined takes the key out. */
export function setKey(
  text: string,
  table: string,
  nth: number,
  key: string,
  value: string | number | string[] | undefined,
): string {
  return setToml(text, table, nth, key, value === undefined ? undefined : JSON.stringify(value));
}

/** Set the unit of the nth channel, also where its column gives the flight condition. */
export function setUnit(text: string, nth: number, column: string, unit: string): string {
  const changed = setKey(text, "channels", nth, "unit", unit);
  return CONDITIONS.reduce((edited, key) => {
    const quantity = readQuantity(edited, CONDITION, key);
    return quantity?.given === column
      ? setToml(edited, CONDITION, 0, key, writeQuantity(column, unit))
      : edited;
  }, changed);
}

/** Set a key to a value written as TOML, which confirms it; undefined takes the key out. */
export function setToml(
  text: string,
  table: string,
  nth: number,
  key: string,
  value: string | undefined,
): string {
  return setLine(confirmKey(text, table, nth, key), table, nth, key, value);
}

function setLine(
  text: string,
  table: string,
  nth: number,
  key: string,
  value: string | undefined,
): string {
  const lines = text.split("\n");
  const found = block(lines, table, nth);
  if (found === null) {
    return value === undefined ? text : `[${table}]\n${key} = ${value}\n\n${text}`;
  }
  const [first, last] = found;
  const at = lines.findIndex((line, index) => index >= first && index < last && isKey(line, key));
  const written = value === undefined ? [] : [`${key} = ${value}`];
  if (at >= 0) {
    lines.splice(at, 1, ...written);
  } else {
    let end = last;
    while (end > first && (lines[end - 1] ?? "").trim() === "") end -= 1;
    lines.splice(end, 0, ...written);
  }
  return lines.join("\n");
}

/** Keys of the nth table of a name that were proposed and that nobody has confirmed. */
export const guessedKeys = (text: string, table: string, nth: number): string[] =>
  readList(text, table, nth, "guessed");

/** Texts of a list of the nth table of a name, written on one line. */
export function readList(text: string, table: string, nth: number, key: string): string[] {
  const lines = text.split("\n");
  const found = block(lines, table, nth);
  if (found === null) return [];
  const line = lines.slice(...found).find((own) => isKey(own, key));
  return [...(line ?? "").replace(/^[^=]*=/, "").matchAll(/"([^"]*)"/g)].map(
    ([, one]) => one ?? "",
  );
}

/** Take the mark away from a key that somebody has confirmed or changed. */
function confirmKey(text: string, table: string, nth: number, key: string): string {
  const guessed = guessedKeys(text, table, nth);
  if (!guessed.includes(key)) return text;
  const rest = guessed.filter((own) => own !== key);
  return setLine(text, table, nth, "guessed", rest.length > 0 ? JSON.stringify(rest) : undefined);
}

/** Confirm the value at a key such as "channels[2].unit". */
export function confirmPath(text: string, path: string): string {
  const cut = path.lastIndexOf(".");
  const [, table, number] = /^(.*?)(?:\[(\d+)\])?$/.exec(path.slice(0, cut)) ?? [];
  const nth = number === undefined ? 0 : Number(number) - 1;
  return table === undefined ? text : confirmKey(text, table, nth, path.slice(cut + 1));
}

/** Take the nth table of a name out. */
export function removeTable(text: string, table: string, nth: number): string {
  const lines = text.split("\n");
  const found = block(lines, table, nth);
  if (found === null) return text;
  lines.splice(found[0] - 1, found[1] - found[0] + 1);
  return lines.join("\n");
}

/** Number of tables of a name. */
export function countTables(text: string, table: string): number {
  return text.split("\n").filter((line) => bare(line) === `[[${table}]]`).length;
}

/** Value of a key of the nth table of a name, written on one line, as text. */
export function readKey(text: string, table: string, key: string, nth = 0): string | undefined {
  const lines = text.split("\n");
  const found = block(lines, table, nth);
  const line = found === null ? undefined : lines.slice(...found).find((own) => isKey(own, key));
  const value = line === undefined ? undefined : /=\s*(?:"([^"]*)"|([^#\s]+))/.exec(line);
  return value?.[1] ?? value?.[2];
}

/** A quantity such as `{ field = "tas", unit = "kt" }`: what gives it (a number or a field). */
export function readQuantity(
  text: string,
  table: string,
  key: string,
): { given: string; unit: string } | undefined {
  const lines = text.split("\n");
  const found = block(lines, table, 0);
  const line = found === null ? undefined : lines.slice(...found).find((own) => isKey(own, key));
  if (line === undefined) return undefined;
  const given = /\bfield\s*=\s*"([^"]*)"|\bvalue\s*=\s*([^\s,}#]+)/.exec(line);
  const plain = /^[^=]*=\s*([-+.\d][^\s#]*)/.exec(line);
  return {
    given: given?.[1] ?? given?.[2] ?? plain?.[1] ?? "",
    unit: /\bunit\s*=\s*"([^"]*)"/.exec(line)?.[1] ?? "1",
  };
}

/** Write a quantity: a number is a value, other text the name of a field. */
export function writeQuantity(given: string, unit: string): string {
  const isNumber = given.trim() !== "" && Number.isFinite(Number(given));
  const source = isNumber
    ? `value = ${tomlNumber(Number(given))}`
    : `field = ${JSON.stringify(given)}`;
  return `{ ${source}, unit = ${JSON.stringify(unit)} }`;
}

function tomlNumber(value: number): string {
  return String(value).replace("e+", "e");
}

/** Add or take out the tables of a maneuver; without them the files are a whole flight. */
export function setManeuver(text: string, isManeuver: boolean): string {
  if (!isManeuver) {
    return removeTable(removeTable(text, "maneuver.condition", 0), "maneuver", 0);
  }
  return `${text.trimEnd()}\n\n[maneuver]\nlabel = "{file}"\n\n[maneuver.condition]\n`;
}

/** Numbers of the tables of channels whose column or name matches a regular expression. */
export function matchRules(
  rules: readonly Record<string, unknown>[],
  pattern: string,
): number[] | undefined {
  let expression: RegExp;
  try {
    expression = new RegExp(pattern, "i");
  } catch {
    return undefined; // not complete yet
  }
  return rules.flatMap((rule, nth) =>
    [rule["name"], rule["column"]].some((own) => typeof own === "string" && expression.test(own))
      ? [nth]
      : [],
  );
}

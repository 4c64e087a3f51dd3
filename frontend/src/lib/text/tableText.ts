/** Text of a table for spreadsheets and programs. */
import { csv } from "./csv";

/** Cells as they are read: symbols by their names, without the arrows of sorted columns. */
function cellText(cell: Element): string {
  const copy = cell.cloneNode(true) as Element;
  for (const hidden of copy.querySelectorAll('[aria-hidden="true"]')) hidden.remove();
  for (const symbol of copy.querySelectorAll('[role="img"][aria-label]')) {
    symbol.replaceWith(symbol.getAttribute("aria-label") ?? "");
  }
  // A spreadsheet reads neither the minus sign of typography nor a dash as a number.
  const text = copy.textContent.replaceAll(/\s+/g, " ").trim();
  return text === "\u2013" ? "" : text.replaceAll("\u2212", "-");
}

const cellsOf = (table: HTMLTableElement): string[][] =>
  [...table.rows].map((row) => [...row.cells].map(cellText));

/** Rows of a table as tab-separated values. */
export function tableText(table: HTMLTableElement): string {
  return cellsOf(table)
    .map((row) => `${row.join("\t")}\n`)
    .join("");
}

/** What is a number, so that a file states it as one; an empty cell is nothing. */
function valueOf(text: string): string | number | null {
  if (text === "") return null;
  const value = Number(text);
  return Number.isFinite(value) ? value : text;
}

/** Rows of a table as a CSV file. */
export const tableCsv = (table: HTMLTableElement): string =>
  csv(cellsOf(table).map((row) => row.map(valueOf)));

/** Columns and rows of a table as a JSON file, which pandas reads with `orient="split"`. */
export function tableJson(table: HTMLTableElement): string {
  const [columns = [], ...rows] = cellsOf(table);
  return `${JSON.stringify({ columns, data: rows.map((row) => row.map(valueOf)) }, null, 1)}\n`;
}

type Row = Record<string, unknown>;

const isObject = (value: unknown): value is Row =>
  typeof value === "object" && value !== null && !Array.isArray(value);

/** Whether rows are data, and nothing that only a page can show. */
export const areRecords = (rows: readonly unknown[]): rows is readonly Row[] =>
  rows.every(
    (row) =>
      isObject(row) &&
      Object.values(row).every((value) => typeof value !== "function" && !isElement(value)),
  );

const isElement = (value: unknown) => isObject(value) && "$$typeof" in value;

/** A row with dotted names in place of objects within it, as the interface writes its tables. */
function flat(row: Row, name = ""): Row {
  const parts = Object.entries(row).map(([key, value]) => {
    const whole = name === "" ? key : `${name}.${key}`;
    return isObject(value) ? flat(value, whole) : { [whole]: value };
  });
  return Object.assign({}, ...parts) as Row;
}

function plain(value: unknown): string | number | null {
  if (value === null || value === undefined) return null;
  return typeof value === "string" || typeof value === "number" ? value : JSON.stringify(value);
}

/** Rows with all their digits as a CSV file, columns by their names in the interface. */
export function recordsCsv(rows: readonly Row[]): string {
  const flattened = rows.map((row) => flat(row));
  const columns = [...new Set(flattened.flatMap((row) => Object.keys(row)))];
  return csv([columns, ...flattened.map((row) => columns.map((name) => plain(row[name])))]);
}

/** Rows with all their digits as a JSON file. */
export const recordsJson = (rows: readonly Row[]): string => `${JSON.stringify(rows, null, 1)}\n`;

/** Copies a text; rejected where the page is not served securely or the browser refuses. */
export async function copyText(text: string): Promise<void> {
  await navigator.clipboard.writeText(text);
}

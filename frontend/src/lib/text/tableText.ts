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

/** Copies a text; rejected where the page is not served securely or the browser refuses. */
export async function copyText(text: string): Promise<void> {
  await navigator.clipboard.writeText(text);
}

/** Text of a table for spreadsheets. */

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

/** Rows of a table as tab-separated values. */
export function tableText(table: HTMLTableElement): string {
  return [...table.rows]
    .map((row) => [...row.cells].map(cellText).join("\t"))
    .map((line) => `${line}\n`)
    .join("");
}

/** Copies a text; rejected where the page is not served securely or the browser refuses. */
export async function copyText(text: string): Promise<void> {
  await navigator.clipboard.writeText(text);
}

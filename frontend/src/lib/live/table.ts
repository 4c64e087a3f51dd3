/** Table of an option, such as the field of each channel, from rows `name = value`. */
export function parseTable(text: string | number): Record<string, string> {
  const rows = String(text)
    .split("\n")
    .filter((row) => row.trim() !== "");
  return Object.fromEntries(
    rows.map((row) => {
      const [name = "", ...value] = row.split("=");
      return [name.trim(), value.join("=").trim()];
    }),
  );
}

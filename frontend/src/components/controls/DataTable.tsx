import { Menu } from "@mantine/core";
import { useRef, useState, type ReactNode, type RefObject } from "react";
import { saveText } from "../../lib/text/csv";
import {
  areRecords,
  copyText,
  recordsCsv,
  recordsJson,
  tableCsv,
  tableJson,
  tableText,
} from "../../lib/text/tableText";
import { SymbolTooltip } from "../display/SymbolTooltip";

export interface Column<Row> {
  key: string;
  header: ReactNode;
  /** Name in the glossary whose meaning is shown when the header is pointed at. */
  help?: string;
  unit?: ReactNode;
  /** Numbers stand at the right so that their digits line up. */
  numeric?: boolean;
  /** Sentences go over several lines; whatever else there is stays on one. */
  wraps?: boolean;
  /** Names that are long go over several lines where the page is narrow. */
  yields?: boolean;
  /** What is shown only where a row has some of it. */
  onlyIf?: (row: Row) => boolean;
  /** Name by which this column is sorted; without one it is not sortable. */
  sort?: string;
  render: (row: Row) => ReactNode;
}

/** A column of numbers. */
export function numeric<Row>(
  key: string,
  header: ReactNode,
  render: (row: Row) => ReactNode,
  unit?: string,
): Column<Row> {
  return { key, header, unit, numeric: true, render };
}

interface Props<Row> {
  columns: Column<Row>[];
  rows: Row[];
  rowKey: (row: Row) => string | number;
  label: string;
  testId?: string;
  rowTestId?: (row: Row) => string;
  isSelected?: (row: Row) => boolean;
  /** `name` ascending, `-name` descending. */
  sort?: string;
  onSort?: (sort: string) => void;
  maxHeight?: number;
}

function nextSort(current: string | undefined, column: string): string {
  return current === column ? `-${column}` : column;
}

/** Rows and columns; headers sort, numbers line up. */
export function DataTable<Row>(props: Props<Row>) {
  const { rows, rowKey, label, testId, rowTestId, isSelected, sort, onSort } = props;
  const columns = props.columns.filter(({ onlyIf }) => onlyIf === undefined || rows.some(onlyIf));
  const table = useRef<HTMLTableElement>(null);
  return (
    <>
      <div
        className="table-scroll"
        style={{ maxHeight: props.maxHeight }}
        role="region"
        aria-label={label}
        tabIndex={0}
      >
        <table ref={table} className="data-table" aria-label={label} data-testid={testId}>
          <thead>
            <tr>
              {columns.map((column) => (
                <HeaderCell key={column.key} column={column} sort={sort} onSort={onSort} />
              ))}
            </tr>
          </thead>
          <tbody>
            {rows.map((row) => (
              <tr
                key={rowKey(row)}
                data-testid={rowTestId?.(row)}
                data-selected={isSelected?.(row) === true ? "true" : undefined}
              >
                {columns.map((column) => (
                  <td key={column.key} className={classOf(column)}>
                    {column.render(row)}
                  </td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      {rows.length > 0 && <CopyTable table={table} rows={rows} label={label} />}
    </>
  );
}

const FILES = [
  ["csv", tableCsv, recordsCsv, "text/csv"],
  ["json", tableJson, recordsJson, "application/json"],
] as const;

/** Copies the rows as they are shown, tab-separated, or saves them with all digits as a file. */
export function CopyTable({
  table,
  rows,
  label,
}: {
  table: RefObject<HTMLTableElement | null>;
  /** What the rows show; without it the files have what is shown. */
  rows?: readonly unknown[];
  label: string;
}) {
  const [state, setState] = useState<"" | "copied" | "failed">("");
  const words = { "": "Copy or save", copied: "Copied", failed: "The browser refused to copy" };
  const name = `flexsid-${label.toLowerCase().replaceAll(/[^a-z0-9]+/g, "-")}`;
  return (
    <div className="table-copy no-print">
      <Menu position="bottom-end">
        <Menu.Target>
          <button type="button" aria-label={`Copy or save table: ${label}`}>
            {words[state]}
          </button>
        </Menu.Target>
        <Menu.Dropdown>
          <Menu.Item
            onClick={() => {
              if (table.current === null) return;
              copyText(tableText(table.current)).then(
                () => {
                  setState("copied");
                },
                () => {
                  setState("failed");
                },
              );
            }}
          >
            Copy for a spreadsheet
          </Menu.Item>
          {FILES.map(([suffix, writeShown, writeRecords, type]) => (
            <Menu.Item
              key={suffix}
              onClick={() => {
                if (table.current === null) return;
                const text =
                  rows !== undefined && areRecords(rows)
                    ? writeRecords(rows)
                    : writeShown(table.current);
                saveText(text, `${name}.${suffix}`, type);
              }}
            >
              {suffix.toUpperCase()}
            </Menu.Item>
          ))}
        </Menu.Dropdown>
      </Menu>
    </div>
  );
}

function classOf<Row>(column: Column<Row>): string | undefined {
  if (column.numeric === true) return "end";
  if (column.wraps === true) return "wraps";
  return column.yields === true ? "yields" : undefined;
}

interface HeaderProps<Row> {
  column: Column<Row>;
  sort?: string;
  onSort?: (sort: string) => void;
}

function HeaderCell<Row>({ column, sort, onSort }: HeaderProps<Row>) {
  const name = column.sort;
  const direction =
    name === undefined
      ? undefined
      : sort === name
        ? "ascending"
        : sort === `-${name}`
          ? "descending"
          : undefined;
  const arrow = direction === "ascending" ? "↑" : direction === "descending" ? "↓" : "";
  const content = (
    <>
      {column.help === undefined ? (
        column.header
      ) : (
        <SymbolTooltip name={column.help}>{column.header}</SymbolTooltip>
      )}
      {column.unit !== undefined && <span className="unit"> [{column.unit}]</span>}
    </>
  );
  return (
    <th scope="col" className={column.numeric === true ? "end" : undefined} aria-sort={direction}>
      {name !== undefined && onSort !== undefined ? (
        <button
          type="button"
          onClick={() => {
            onSort(nextSort(sort, name));
          }}
        >
          {content}
          <span className="arrow" aria-hidden="true">
            {arrow}
          </span>
        </button>
      ) : (
        content
      )}
    </th>
  );
}

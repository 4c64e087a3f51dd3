import type { Aircraft, ModalTable } from "../../api/types";
import type { ModalDataView } from "../../views";

/** What every tab is handed. */
export interface TabProps {
  aircraft: Aircraft;
  /** Tables with frequencies, of any kind and version. */
  usable: ModalTable[];
  view: ModalDataView;
  onChange: (change: Partial<ModalDataView>) => void;
}

/** What every tab of a table is handed. */
export interface TableProps extends TabProps {
  table: ModalTable;
}

/** What a table is called among others of its name. */
export const tableTitle = (table: ModalTable): string =>
  [
    table.version > 1 ? `${table.name} (version ${String(table.version)})` : table.name,
    ...(table.name.includes(table.kind) ? [] : [table.kind]),
  ].join(", ");

/** Whether single modes of a table can be drawn. */
export const hasShapes = (table: ModalTable): boolean => "nodes" in table.arrays;

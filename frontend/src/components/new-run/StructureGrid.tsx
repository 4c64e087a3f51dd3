import { Button, Group, Text } from "@mantine/core";
import { useRef, type KeyboardEvent, type ReactNode } from "react";
import { coefficients, derivativeNames, variables } from "../../lib/derivatives";
import {
  counts,
  EMPTY_STATES,
  stateOf,
  stateText,
  withState,
  type DerivativeState,
  type States,
} from "../../lib/structure";
import { CopyTable } from "../controls/DataTable";
import { CoefficientName, VariableName } from "../display/DerivativeName";

interface Props {
  axis: string;
  modes: readonly number[];
  inputs: readonly string[];
  states: States;
  onChange: (states: States) => void;
  onUndo?: () => void;
  onRedo?: () => void;
  /** The cell that the keyboard is in, by the name of its derivative. */
  current?: string;
  onCurrent: (name: string) => void;
  /** Numbers under the state of each derivative. */
  numbers?: (name: string) => ReactNode;
  /** Something small beside the state of a derivative. */
  marks?: (name: string) => ReactNode;
  /** What a derivative was in the structure that is compared with, where it differs. */
  before?: (name: string) => string | undefined;
  /** Nothing can be changed. */
  readOnly?: boolean;
}

const STEPS: Record<string, [number, number]> = {
  ArrowUp: [-1, 0],
  ArrowDown: [1, 0],
  ArrowLeft: [0, -1],
  ArrowRight: [0, 1],
};
const KEYS: Record<string, DerivativeState> = { f: "free", x: "fixed", " ": "absent" };
const MARKS: Record<DerivativeState, string> = { free: "free", fixed: "fixed", absent: "–" };

/**
 * One cell per derivative: rows are coefficients, columns variables. Arrow keys move; F
 * frees, X fixes, Space takes away (again: gives back); a name does its row or column.
 */
export function StructureGrid(props: Props) {
  const { axis, modes, inputs, states, onChange, numbers, before, readOnly = false } = props;
  const rows = coefficients(modes, axis);
  const columns = variables(modes, inputs, axis);
  const all = derivativeNames(modes, inputs, axis);
  const grid = useRef<HTMLTableElement>(null);
  // The grid shrinks when modes are taken away; the one tab stop stays inside it.
  const current =
    props.current !== undefined && all.includes(props.current) ? props.current : all[0];

  const set = (names: string[], state: DerivativeState) => {
    if (!readOnly) onChange(withState(states, all, names, state));
  };
  const toggle = (names: string[]) => {
    set(names, names.every((name) => stateOf(states, name) === "free") ? "fixed" : "free");
  };
  const goTo = (row: number, column: number) => {
    const r = rows[Math.max(0, Math.min(rows.length - 1, row))];
    const c = columns[Math.max(0, Math.min(columns.length - 1, column))];
    if (r === undefined || c === undefined) return;
    const name = `${r}_${c}`;
    props.onCurrent(name);
    grid.current?.querySelector<HTMLButtonElement>(`[data-name="${name}"]`)?.focus();
  };
  const press = (event: KeyboardEvent, name: string, row: number, column: number) => {
    const key = event.key.toLowerCase();
    if (event.ctrlKey || event.metaKey) {
      if (key === "z" && !event.shiftKey) props.onUndo?.();
      else if (key === "y" || key === "z") props.onRedo?.();
      else return;
      event.preventDefault();
      return;
    }
    if (event.altKey) return;
    const step = STEPS[event.key];
    const state = KEYS[key];
    if (step !== undefined) goTo(row + step[0], column + step[1]);
    else if (key === "home") goTo(row, 0);
    else if (key === "end") goTo(row, columns.length - 1);
    else if (state !== undefined) {
      set([name], state !== "free" && stateOf(states, name) === state ? "free" : state);
    } else return;
    event.preventDefault();
  };
  const count = counts(states, all);

  return (
    <div>
      <div className="table-scroll">
        <table
          className="derivative-grid"
          data-numbers={numbers !== undefined}
          ref={grid}
          role="grid"
          aria-label="Derivatives"
          aria-readonly={readOnly}
        >
          <thead>
            <tr role="row">
              <td />
              {columns.map((column) => (
                <th key={column} scope="col" role="columnheader">
                  <button
                    type="button"
                    tabIndex={-1}
                    title={`All with respect to ${column}`}
                    onClick={() => {
                      toggle(rows.map((row) => `${row}_${column}`));
                    }}
                  >
                    <VariableName variable={column} />
                  </button>
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {rows.map((row, r) => (
              <tr key={row} role="row">
                <th scope="row" role="rowheader">
                  <button
                    type="button"
                    tabIndex={-1}
                    title={`All of ${row}`}
                    onClick={() => {
                      toggle(columns.map((column) => `${row}_${column}`));
                    }}
                  >
                    <CoefficientName coefficient={row} />
                  </button>
                </th>
                {columns.map((column, c) => {
                  const name = `${row}_${column}`;
                  const state = stateOf(states, name);
                  const was = before?.(name);
                  const text = `${name}: ${stateText(states, name)}`;
                  return (
                    <td key={column} role="gridcell" aria-selected={name === current}>
                      <button
                        type="button"
                        className="cell"
                        aria-label={was === undefined ? text : `${text}, before: ${was}`}
                        title={was === undefined ? text : `${text}\nbefore: ${was}`}
                        data-name={name}
                        data-state={state}
                        data-differs={was !== undefined}
                        tabIndex={name === current ? 0 : -1}
                        onFocus={() => {
                          props.onCurrent(name);
                        }}
                        onKeyDown={(event) => {
                          press(event, name, r, c);
                        }}
                        onDoubleClick={() => {
                          toggle([name]);
                        }}
                      >
                        <span className="state">
                          {MARKS[state]}
                          {props.marks?.(name)}
                        </span>
                        {numbers?.(name)}
                      </button>
                    </td>
                  );
                })}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <CopyTable table={grid} label="Derivatives" />
      <Group gap="sm" mt="xs">
        <Text size="xs" className="quiet numbers" data-testid="free-count">
          {count.free} of {all.length} free, {count.fixed} fixed, {count.absent} absent
        </Text>
        {!readOnly && (
          <Button
            variant="subtle"
            size="compact-xs"
            onClick={() => {
              onChange(EMPTY_STATES);
            }}
          >
            Free all
          </Button>
        )}
        {!readOnly && (
          <Text size="xs" className="quiet">
            Arrow keys move, <kbd>F</kbd> free, <kbd>X</kbd> fixed, <kbd>Space</kbd> absent,{" "}
            <kbd>Ctrl Z</kbd> undo; a name does its row or column.
          </Text>
        )}
      </Group>
    </div>
  );
}

import { Button, Group, Text } from "@mantine/core";
import { useRef, useState, type KeyboardEvent } from "react";
import { coefficients, derivativeNames, variables } from "../lib/derivatives";
import { CoefficientName, VariableName } from "./DerivativeName";

interface Props {
  modes: readonly number[];
  inputs: readonly string[];
  /** Names of the free derivatives; null frees all. */
  free: readonly string[] | null;
  onChange: (free: string[] | null) => void;
}

const STEPS: Record<string, [number, number]> = {
  ArrowUp: [-1, 0],
  ArrowDown: [1, 0],
  ArrowLeft: [0, -1],
  ArrowRight: [0, 1],
};

/**
 * One switch per derivative: rows are coefficients, columns variables. Arrow keys
 * move, Space toggles; a row's or column's name toggles all of it.
 */
export function DerivativeGrid({ modes, inputs, free, onChange }: Props) {
  const rows = coefficients(modes);
  const columns = variables(modes, inputs);
  const all = derivativeNames(modes, inputs);
  const isFree = (name: string) => free === null || free.includes(name);
  const grid = useRef<HTMLTableElement>(null);
  const [place, setPlace] = useState<[number, number]>([0, 0]);
  // The grid shrinks when modes are taken away; the one tab stop stays inside it.
  const current = [Math.min(place[0], rows.length - 1), Math.min(place[1], columns.length - 1)];

  const set = (names: string[], value: boolean) => {
    const next = all.filter((name) => (names.includes(name) ? value : isFree(name)));
    onChange(next.length === all.length ? null : next);
  };
  const toggleAll = (names: string[]) => {
    set(names, !names.every(isFree));
  };
  const move = (event: KeyboardEvent, row: number, column: number) => {
    const step = STEPS[event.key];
    if (step === undefined) return;
    event.preventDefault();
    const to: [number, number] = [
      Math.max(0, Math.min(rows.length - 1, row + step[0])),
      Math.max(0, Math.min(columns.length - 1, column + step[1])),
    ];
    setPlace(to);
    grid.current?.querySelector<HTMLButtonElement>(`[data-place="${to[0]},${to[1]}"]`)?.focus();
  };

  return (
    <div>
      <div className="table-scroll">
        <table className="derivative-grid" ref={grid} role="grid" aria-label="Free derivatives">
          <thead>
            <tr role="row">
              <td />
              {columns.map((column) => (
                <th key={column} scope="col" role="columnheader">
                  <button
                    type="button"
                    title={`Toggle all with respect to ${column}`}
                    onClick={() => {
                      toggleAll(rows.map((row) => `${row}_${column}`));
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
                    title={`Toggle all of ${row}`}
                    onClick={() => {
                      toggleAll(columns.map((column) => `${row}_${column}`));
                    }}
                  >
                    <CoefficientName coefficient={row} />
                  </button>
                </th>
                {columns.map((column, c) => {
                  const name = `${row}_${column}`;
                  const on = isFree(name);
                  return (
                    <td key={column} role="gridcell">
                      <button
                        type="button"
                        role="checkbox"
                        className="cell"
                        aria-label={name}
                        aria-checked={on}
                        title={name}
                        data-place={`${r},${c}`}
                        tabIndex={r === current[0] && c === current[1] ? 0 : -1}
                        onFocus={() => {
                          setPlace([r, c]);
                        }}
                        onKeyDown={(event) => {
                          move(event, r, c);
                        }}
                        onClick={() => {
                          set([name], !on);
                        }}
                      >
                        {on ? "✓" : ""}
                      </button>
                    </td>
                  );
                })}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <Group gap="sm" mt="xs">
        <Text size="xs" className="quiet numbers" data-testid="free-count">
          {free === null ? all.length : free.filter((name) => all.includes(name)).length} of{" "}
          {all.length} free
        </Text>
        <Button
          variant="subtle"
          size="compact-xs"
          onClick={() => {
            onChange(null);
          }}
        >
          Free all
        </Button>
      </Group>
    </div>
  );
}

/** States of the derivatives of a model structure, as the editor changes them. */
import { derivativeNames } from "./derivatives";

export const DERIVATIVE_STATES = ["free", "fixed", "absent"] as const;
export type DerivativeState = (typeof DERIVATIVE_STATES)[number];

export interface FixedTo {
  source: "prediction" | "run";
  id: number;
}

/** States of the derivatives in a structure. */
export interface States {
  /** Null frees all that is neither absent nor fixed. */
  free: string[] | null;
  absent: string[];
  fixed: Record<string, number>;
  fixed_to: Record<string, FixedTo>;
}

/** Where a derivative that is not free is held. */
export type Held = { source: "start" } | { source: "number"; value: number } | FixedTo;

export interface Structure extends States {
  modes: number[];
  inputs: string[];
  outputs: string[];
  free_delays: boolean;
  extra_parameters: string[];
  axis: string;
  delays: Record<string, number>;
  instruments: Record<string, string | null>;
}

export const EMPTY_STATES: States = { free: null, absent: [], fixed: {}, fixed_to: {} };

export function stateOf(states: States, name: string): DerivativeState {
  if (states.absent.includes(name)) return "absent";
  if (name in states.fixed || name in states.fixed_to) return "fixed";
  return states.free === null || states.free.includes(name) ? "free" : "fixed";
}

export function heldAt(states: States, name: string): Held {
  const value = states.fixed[name];
  if (value !== undefined) return { source: "number", value };
  return states.fixed_to[name] ?? { source: "start" };
}

/** Set the state of some derivatives; fixed ones are held at the start by default. */
export function withState(
  states: States,
  all: readonly string[],
  names: readonly string[],
  state: DerivativeState,
  held: Held = { source: "start" },
): States {
  const others = (name: string) => !names.includes(name);
  const fixed = without(states.fixed, names);
  const fixedTo = without(states.fixed_to, names);
  let startHeld = all.filter(
    (name) =>
      others(name) && stateOf(states, name) === "fixed" && heldAt(states, name).source === "start",
  );
  const absent = states.absent.filter(others);
  if (state === "absent") absent.push(...names);
  if (state === "fixed") {
    if (held.source === "start") startHeld = [...startHeld, ...names];
    else if (held.source === "number") for (const name of names) fixed[name] = held.value;
    else for (const name of names) fixedTo[name] = held;
  }
  return {
    absent: all.filter((name) => absent.includes(name)),
    fixed,
    fixed_to: fixedTo,
    free: freeList(all, startHeld, absent, fixed, fixedTo),
  };
}

/** The structure with other modes or inputs; new derivatives are free. */
export function resized(
  structure: Structure,
  part: Partial<Pick<Structure, "modes" | "inputs">>,
  surfaces: readonly string[],
): Structure {
  const next = { ...structure, ...part };
  const names = (one: Structure) =>
    derivativeNames(one.modes, one.inputs.length > 0 ? one.inputs : surfaces, one.axis);
  const before = names(structure);
  const after = names(next);
  const gone = before.filter((name) => !after.includes(name));
  const held = after.filter(
    (name) => before.includes(name) && structure.free?.includes(name) === false,
  );
  const states: States = {
    free: null,
    absent: structure.absent.filter((name) => after.includes(name)),
    fixed: without(structure.fixed, gone),
    fixed_to: without(structure.fixed_to, gone),
  };
  const start = held.filter((name) => stateOf(states, name) === "free");
  return { ...next, ...withState(states, after, start, start.length > 0 ? "fixed" : "free") };
}

export function counts(states: States, all: readonly string[]): Record<DerivativeState, number> {
  const found = { free: 0, fixed: 0, absent: 0 };
  for (const name of all) found[stateOf(states, name)] += 1;
  return found;
}

export function heldText(held: Held): string {
  if (held.source === "start") return "the start of the run";
  if (held.source === "number") return String(held.value);
  return `${held.source} ${held.id}`;
}

/** Text of a derivative's state: `free`, `absent`, `fixed to prediction 2`. */
export function stateText(states: States, name: string): string {
  const state = stateOf(states, name);
  return state === "fixed" ? `fixed to ${heldText(heldAt(states, name))}` : state;
}

export interface Difference {
  /** Derivative, or the part of the structure that differs. */
  what: string;
  before: string;
  after: string;
}

/** What differs between two structures: derivatives first, then the rest. */
export function differences(
  before: Structure,
  after: Structure,
  surfaces: readonly string[],
): Difference[] {
  const names = (one: Structure) =>
    derivativeNames(one.modes, one.inputs.length > 0 ? one.inputs : surfaces, one.axis);
  const [old, now] = [names(before), names(after)];
  const stateIn = (one: Structure, known: string[], name: string) =>
    known.includes(name) ? stateText(one, name) : "not in the model";
  const derivatives = [...new Set([...now, ...old])].map((name) => ({
    what: name,
    before: stateIn(before, old, name),
    after: stateIn(after, now, name),
  }));
  const listed = (items: readonly (string | number)[], none: string) =>
    items.length > 0 ? items.join(", ") : none;
  const rest = (one: Structure): Record<string, string> => ({
    modes: listed(one.modes, "none"),
    inputs: listed(one.inputs, "all of the maneuver"),
    outputs: listed(one.outputs, "all suitable"),
    "time delays": one.free_delays ? "estimated" : "held",
    "extra parameters": listed(one.extra_parameters, "nothing"),
    delays: listed(
      Object.entries(one.delays).map(([name, value]) => `${name} ${value} s`),
      "none",
    ),
    instruments: listed(
      Object.entries(one.instruments).map(([name, value]) => `${name}: ${value ?? "none"}`),
      "as on the aircraft",
    ),
  });
  const [was, is] = [rest(before), rest(after)];
  const others = Object.keys(is).map((what) => ({
    what,
    before: was[what] ?? "",
    after: is[what] ?? "",
  }));
  return [...derivatives, ...others].filter((one) => one.before !== one.after);
}

/**
 * My changes on top of theirs, both made from the same base; where both changed the
 * same derivative or part, mine is used and listed.
 */
export function merged(
  base: Structure,
  theirs: Structure,
  mine: Structure,
  surfaces: readonly string[],
): { structure: Structure; clashes: string[] } {
  const my = differences(base, mine, surfaces);
  const their = new Map(differences(base, theirs, surfaces).map((one) => [one.what, one.after]));
  const clashes = my
    .filter((one) => their.has(one.what) && their.get(one.what) !== one.after)
    .map((one) => one.what);
  const changed = (what: string) => my.some((one) => one.what === what);
  let result: Structure = resized(
    theirs,
    {
      ...(changed("modes") ? { modes: mine.modes } : {}),
      ...(changed("inputs") ? { inputs: mine.inputs } : {}),
    },
    surfaces,
  );
  const known = result.inputs.length > 0 ? result.inputs : surfaces;
  const all = derivativeNames(result.modes, known, result.axis);
  for (const { what } of my) {
    if (!all.includes(what)) continue;
    result = {
      ...result,
      ...withState(result, all, [what], stateOf(mine, what), heldAt(mine, what)),
    };
  }
  return {
    structure: {
      ...result,
      ...(changed("outputs") ? { outputs: mine.outputs } : {}),
      ...(changed("time delays") ? { free_delays: mine.free_delays } : {}),
      ...(changed("extra parameters") ? { extra_parameters: mine.extra_parameters } : {}),
      ...(changed("delays") ? { delays: mine.delays } : {}),
      ...(changed("instruments") ? { instruments: mine.instruments } : {}),
    },
    clashes,
  };
}

function freeList(
  all: readonly string[],
  startHeld: readonly string[],
  absent: readonly string[],
  fixed: Record<string, number>,
  fixedTo: Record<string, FixedTo>,
): string[] | null {
  if (!all.some((name) => startHeld.includes(name))) return null;
  return all.filter(
    (name) =>
      !startHeld.includes(name) && !absent.includes(name) && !(name in fixed) && !(name in fixedTo),
  );
}

function without<T>(record: Record<string, T>, names: readonly string[]): Record<string, T> {
  return Object.fromEntries(Object.entries(record).filter(([name]) => !names.includes(name)));
}

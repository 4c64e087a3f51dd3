/** Draft of a custom design, and its conversion to a request. */
import { significant } from "../text/format";

export const AXES = ["symmetric", "antisymmetric", "independent"] as const;
export type Axis = (typeof AXES)[number];

export interface DraftInput {
  name: string;
  low: number;
  high: number;
  count: number;
  relative: number;
  /** Frequencies [Hz], separated by commas. */
  targets: string;
  /** Points such as "0.3:1, 12:0.01": frequency [Hz] and relative power. */
  spectrum: string;
}

interface DesignDraft {
  name: string;
  duration: number;
  rate: number;
  /** Largest command at the three amplitudes [deg]. */
  peaks: [number, number, number];
  effort: "quick" | "thorough" | "patient";
  surfaces: string;
  axis: Axis;
  inputs: DraftInput[];
}

export const EMPTY_DRAFT: DesignDraft = {
  name: "",
  duration: 24,
  rate: 100,
  peaks: [1, 2, 4],
  effort: "thorough",
  surfaces: "bf, wf3, wf1, wf4, wf2",
  axis: "symmetric",
  inputs: [],
};

const SUFFIXES: Record<Axis, readonly string[]> = {
  symmetric: ["s"],
  antisymmetric: ["a"],
  independent: ["l", "r"],
};

/** Inputs of surfaces moved symmetrically, antisymmetrically, or left and right separately. */
export function inputsOf(draft: DesignDraft): DraftInput[] {
  const last = draft.inputs.at(-1);
  const known = new Set(draft.inputs.map((own) => own.name));
  return draft.surfaces
    .split(",")
    .map((part) => part.trim())
    .filter((part) => part !== "")
    .flatMap((surface) => SUFFIXES[draft.axis].map((suffix) => surface + suffix))
    .filter((name) => !known.has(name))
    .map((name) => ({
      name,
      low: last?.low ?? 0.25,
      high: last?.high ?? 12,
      count: last?.count ?? 40,
      relative: 1,
      targets: last?.targets ?? "",
      spectrum: last?.spectrum ?? "",
    }));
}

/** Lowest to highest frequency of any input of a design [Hz]. */
export function bandOf({
  specification,
}: {
  specification: { duration_s: number; inputs: { harmonics: number[] }[] };
}): string {
  const every = specification.inputs.flatMap((own) => own.harmonics);
  const [low, high] = [Math.min(...every), Math.max(...every)].map(
    (k) => k / specification.duration_s,
  );
  return `${significant(low, 2)}–${significant(high, 3)}`;
}

const RADIAN = Math.PI / 180;

/** The request, or a message about the entry that cannot be read. */
export function requestOf(draft: DesignDraft) {
  const bands = [];
  for (const own of draft.inputs) {
    const targets = numbers(own.targets);
    const spectrum = own.spectrum
      .split(",")
      .filter((part) => part.trim() !== "")
      .map((part) => part.split(":").map(Number));
    if (targets === undefined)
      return `The targets of ${own.name} are not frequencies in Hz; enter numbers separated by commas`;
    if (spectrum.some((point) => point.length !== 2 || !point.every((x) => x > 0))) {
      return `The power of ${own.name} has the wrong form; enter points such as 0.3:1, 12:0.01`;
    }
    bands.push({
      name: own.name,
      low_hz: own.low,
      high_hz: own.high,
      count: own.count,
      relative_peak: own.relative,
      targets_hz: targets,
      spectrum: spectrum as [number, number][],
    });
  }
  const [low, medium, high] = draft.peaks;
  return {
    name: draft.name,
    duration_s: draft.duration,
    rate_hz: draft.rate,
    peaks: [low * RADIAN, medium * RADIAN, high * RADIAN] as [number, number, number],
    fuel_fraction: 0.5,
    altitude_m: 0,
    first_harmonic: 1,
    inputs: [],
    bands,
    effort: draft.effort,
    seed: 0,
    note: "",
  };
}

function numbers(text: string): number[] | undefined {
  const parts = text.split(",").filter((part) => part.trim() !== "");
  const values = parts.map(Number);
  return values.every((value) => value > 0) ? values : undefined;
}

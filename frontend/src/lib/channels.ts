/** Which channels a page offers, in which order, and what it shows first. */

interface ChannelLike {
  name: string;
  unit: string;
  role: "input" | "output" | "command" | "condition";
}

const ROLE_NAMES: [ChannelLike["role"], string][] = [
  ["input", "Inputs"],
  ["output", "Outputs"],
  ["command", "Commands"],
  ["condition", "Flight condition"],
];

export function byRole(channels: readonly ChannelLike[], roles = ROLE_NAMES.map(([role]) => role)) {
  return ROLE_NAMES.filter(([role]) => roles.includes(role))
    .map(([role, label]) => ({
      label,
      items: channels
        .filter((channel) => channel.role === role)
        .map((channel) => ({ name: channel.name, note: channel.unit })),
    }))
    .filter((group) => group.items.length > 0);
}

/** Combinations, such as half the difference of left and right, whose channels were all recorded. */
export function combined(
  channels: readonly ChannelLike[],
  combinations: readonly { name: string; terms: (string | number)[][] }[],
): string[] {
  const recorded = new Set<string | number | undefined>(channels.map((channel) => channel.name));
  return combinations
    .filter((one) => one.terms.every(([channel]) => recorded.has(channel)))
    .map((one) => one.name);
}

export const named = (channels: readonly ChannelLike[], role: ChannelLike["role"]): string[] =>
  channels.filter((channel) => channel.role === role).map((channel) => channel.name);

/** Inputs with an excitation of their own; without one, all measured inputs. */
export function excitedInputs(maneuver: {
  channels: readonly ChannelLike[];
  excitation: { harmonics: Record<string, number[]> } | null;
}): string[] {
  const excited = Object.keys(maneuver.excitation?.harmonics ?? {});
  return excited.length > 0 ? excited : named(maneuver.channels, "input");
}

/** Default channels: two inputs, then rigid-body motion, then further outputs. */
export function firstLook(channels: readonly ChannelLike[]): string[] {
  const outputs = named(channels, "output");
  const rigid = ["alpha", "q", "az_egi"].filter((name) => outputs.includes(name));
  const rest = outputs.filter((name) => !rigid.includes(name));
  return [...named(channels, "input").slice(0, 2), ...[...rigid, ...rest].slice(0, 4)];
}

/** Rates of the axes that a maneuver excites, as recorded; else its first output. */
export function rateOutputs(maneuver: {
  axis: string;
  channels: readonly ChannelLike[];
}): string[] {
  const outputs = named(maneuver.channels, "output");
  const rates = { lateral: ["p"], combined: ["q", "p"] }[maneuver.axis] ?? ["q"];
  const recorded = rates.filter((name) => outputs.includes(name));
  return recorded.length > 0 ? recorded : outputs.slice(0, 1);
}

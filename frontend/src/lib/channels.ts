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

/** Channels of a maneuver by role, with what the aircraft combines from them. */
export function offeredChannels(
  maneuver: {
    channels: readonly ChannelLike[];
    default_channels: { combinations: string[] };
  },
  roles?: ChannelLike["role"][],
) {
  const groups = byRole(maneuver.channels, roles);
  const names = maneuver.default_channels.combinations;
  if (names.length === 0) return groups;
  const combinations = { label: "Combined", items: names.map((name) => ({ name, note: "" })) };
  const after = groups.findIndex((group) => group.label === "Inputs") + 1;
  return groups.toSpliced(after, 0, combinations);
}

/** Channels of time histories at first: two inputs, then rigid-body motion. */
export function firstLook({ inputs, outputs }: { inputs: string[]; outputs: string[] }): string[] {
  return [...inputs.slice(0, 2), ...outputs.slice(0, 5)];
}

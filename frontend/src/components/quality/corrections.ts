/** Corrections that follow from what was found about channels. */
import type { ChannelQuality, StepRequest } from "../../api/types";

/** What a correction of each kind does to a channel. */
export const TAKE = {
  delay: "Correct the delay of",
  calibration: "Calibrate",
  repair: "Repair",
  interpolation: "Interpolate",
};

const NONE = {
  delay_s: 0,
  scale: 1,
  bias: 0,
  stretches: [] as [number, number][],
  basis: "",
  is_shared: false,
  between_samples: "smooth" as const,
};
const SIGMAS = 3;
/** Of some fifty channels one stands out of three by chance. */
const SKEW_SIGMAS = 4;
const LEAST_SKEW_S = 1e-3;
/** Modes that the model has not look like a skew of a surface of up to a millisecond. */
const LEAST_INPUT_SKEW_S = 3e-3;
/** Of the scale factors of all sensors one stands out of three by chance, too. */
const SCALE = { least: 0.02, sigmas: 4 };
const SURE_S = 5e-3;

/** Delays that stand out of their errors. */
export function delaysOf(channels: ChannelQuality[], band: string): StepRequest[] {
  return channels.flatMap((one) => {
    const { delay_s: delay, delay_std: std } = one;
    if (delay === null || std === null) return [];
    const least = one.role === "input" ? LEAST_INPUT_SKEW_S : LEAST_SKEW_S;
    if (std >= SURE_S || Math.abs(delay) <= Math.max(least, SKEW_SIGMAS * std)) return [];
    return [
      {
        ...NONE,
        channel: one.name,
        kind: "delay" as const,
        delay_s: delay,
        std,
        basis: `redundancy of the sensors, ${band}`,
      },
    ];
  });
}

/** Scale factors and biases that stand out of their errors. */
export function calibrationsOf(channels: ChannelQuality[]): StepRequest[] {
  return channels.flatMap((one) => {
    const scale = sure(one.scale === null ? null : one.scale - 1, one.scale_std, SCALE);
    const bias = sure(one.bias, one.bias_std);
    if (scale === 0 && bias === 0) return [];
    return [
      {
        ...NONE,
        channel: one.name,
        kind: "calibration" as const,
        scale: 1 + scale,
        bias,
        std: one.scale_std,
        basis: ["kinematic consistency", one.bias_basis].filter(Boolean).join("; "),
      },
    ];
  });
}

/** Spikes, which a spline replaces; what is longer would be invented. */
export function repairsOf(channels: ChannelQuality[]): StepRequest[] {
  return channels.flatMap((one) => {
    const stretches = one.stretches
      .filter((part) => part.kind === "spike")
      .map((part): [number, number] => [part.first, part.stop]);
    return stretches.length === 0
      ? []
      : [{ ...NONE, channel: one.name, kind: "repair" as const, stretches, basis: "spikes" }];
  });
}

function sure(
  value: number | null,
  std: number | null,
  { least, sigmas } = { least: 0, sigmas: SIGMAS },
): number {
  if (value === null || std === null) return 0;
  return Math.abs(value) > Math.max(least, sigmas * std) ? value : 0;
}

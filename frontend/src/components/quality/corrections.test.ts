import { expect, test } from "vitest";
import type { ChannelQuality } from "../../api/types";
import { calibrationsOf, delaysOf, repairsOf } from "./corrections";

const sound: ChannelQuality = {
  name: "q",
  role: "output",
  unit: "rad/s",
  signal_to_noise_db: 30,
  coherence: 0.99,
  noise_excess: 1,
  delay_s: 0.0002,
  delay_std: 0.0001,
  scale: 1.001,
  scale_std: 0.002,
  bias: 0.00001,
  bias_std: 0.00002,
  bias_basis: "",
  saturated: 0,
  n_stretches: 0,
  stretches: [],
  not_checked: null,
};

test("what does not stand out of its error is not corrected", () => {
  expect(delaysOf([sound], "")).toEqual([]);
  expect(calibrationsOf([sound])).toEqual([]);
  expect(repairsOf([sound])).toEqual([]);
  expect(delaysOf([{ ...sound, delay_s: 0.02, delay_std: 0.01 }], "")).toEqual([]);
  expect(delaysOf([{ ...sound, delay_s: null }], "")).toEqual([]);
});

test("skews, calibration and spikes become corrections with their basis", () => {
  const [delay] = delaysOf([{ ...sound, delay_s: -0.008 }], "0.25 to 13.75 Hz");
  expect(delay).toMatchObject({ channel: "q", kind: "delay", delay_s: -0.008 });
  expect(delay?.basis).toContain("13.75 Hz");
  expect(calibrationsOf([{ ...sound, scale: 1.05 }])[0]).toMatchObject({ scale: 1.05, bias: 0 });
  const spike = { kind: "spike" as const, first: 10, stop: 11, start_s: 0.05 };
  const held = { kind: "dropout" as const, first: 50, stop: 90, start_s: 0.25 };
  expect(repairsOf([{ ...sound, stretches: [spike, held] }])[0]?.stretches).toEqual([[10, 11]]);
});

import { screen } from "@testing-library/react";
import { afterEach, expect, it, vi } from "vitest";
import { storeUnits } from "../../api/units";
import { show } from "../../test/render";
import { Sentence } from "./Quantity";

const RADIANS = { unit: "Hz", display_unit: "rad/s", factor: 6.283185 };
const KNOT = { unit: "m/s", display_unit: "kt", factor: 1.943844 };

afterEach(() => {
  vi.unstubAllGlobals();
  localStorage.clear();
});

it("shows airspeeds and Hz of a sentence in display units, and nothing else", async () => {
  vi.stubGlobal("fetch", () => Promise.resolve(Response.json({ items: [KNOT, RADIANS] })));
  storeUnits({ units: "us", frequency_unit: "rad/s" });
  await show(
    <p>
      <Sentence text="Flutter at 59.0 ± 2.2 m/s, 19.1 rad/s; from 20 to 60.5 m/s, 3 m/s²; SW1B (3.14 Hz)." />
    </p>,
  );
  expect(
    await screen.findByText(
      "Flutter at 114.7 ± 4.3 kt, 19.1 rad/s; from 39 to 117.6 kt, 3 m/s²; SW1B (19.73 rad/s).",
    ),
  ).toBeInTheDocument();
});

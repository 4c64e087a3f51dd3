import { describe, expect, it } from "vitest";
import { limitsText, readLimits, typed } from "./limits";

describe("limits of conditions", () => {
  it("come back as they were typed", () => {
    const limits = readLimits({
      fuel_fraction: ["0", "62,5"],
      dynamic_pressure_pa: ["100", "400"],
    });
    expect(limits).toEqual({
      limits: { fuel_fraction: [0, 0.625], dynamic_pressure_pa: [100, 400] },
    });
    expect(typed({ fuel_fraction: [0, 0.625] })).toEqual({ fuel_fraction: ["0", "62.5"] });
  });

  it("report faults", () => {
    expect(readLimits({ airspeed_m_s: ["", "3"] })).toHaveProperty("fault");
    expect(readLimits({ airspeed_m_s: ["3", "3"] })).toHaveProperty("fault");
  });

  it("read as a sentence with units", () => {
    expect(limitsText({ fuel_fraction: [0, 0.5], dynamic_pressure_pa: [0, 400] })).toBe(
      "Dynamic pressure 0 to 400 Pa, Fuel 0 to 50 %",
    );
    expect(limitsText({})).toBe("All conditions");
    const knots = (name: string) =>
      name === "m/s" ? { name: "kt", factor: 3600 / 1852 } : { name, factor: 1 };
    expect(limitsText({ airspeed_m_s: [1852 / 3600, 18520 / 3600] }, knots)).toBe(
      "Airspeed 1 to 10 kt",
    );
  });
});

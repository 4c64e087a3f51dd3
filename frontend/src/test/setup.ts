import "@testing-library/jest-dom/vitest";
import { cleanup } from "@testing-library/react";
import { afterEach, vi } from "vitest";
import { setAxes } from "../lib/derivatives";

afterEach(cleanup);

setAxes([
  {
    axis: "longitudinal",
    symmetry: "symmetric",
    coefficients: ["CZ", "Cm"],
    motions: ["alpha", "q"],
  },
  {
    axis: "lateral",
    symmetry: "antisymmetric",
    coefficients: ["CY", "Cl", "Cn"],
    motions: ["beta", "p", "r"],
  },
  {
    axis: "longitudinal-airspeed",
    symmetry: "symmetric",
    coefficients: ["CZ", "Cm", "CX"],
    motions: ["alpha", "q", "V"],
  },
]);

// jsdom lays nothing out; Mantine only needs these to exist.
vi.stubGlobal(
  "ResizeObserver",
  class {
    observe() {}
    unobserve() {}
    disconnect() {}
  },
);
vi.stubGlobal("matchMedia", (query: string) => ({
  matches: false,
  media: query,
  onchange: null,
  addEventListener: () => {},
  removeEventListener: () => {},
  addListener: () => {},
  removeListener: () => {},
  dispatchEvent: () => false,
}));
vi.stubGlobal("scrollTo", () => {});
// Mantine measures text again when fonts are loaded.
Object.defineProperty(document, "fonts", { value: new EventTarget(), configurable: true });

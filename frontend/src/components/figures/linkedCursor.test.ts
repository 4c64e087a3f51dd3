import { expect, it } from "vitest";
import { followCursor } from "./linkedCursor";

function figure(perUnit: number) {
  const drawn = Object.assign(document.createElement("div"), {
    _fullLayout: {
      xaxis: {
        _offset: 50,
        _length: 400,
        d2p: (x: number) => perUnit * x,
        p2d: (pixels: number) => pixels / perUnit,
      },
      _size: { t: 20, h: 300 },
    },
  });
  return { drawn, line: document.createElement("div") };
}

const move = (drawn: HTMLElement, clientX: number) =>
  drawn.dispatchEvent(new MouseEvent("mousemove", { clientX }));

it("is shown at the same place of the other figures, and of no other quantity", () => {
  const [one, other, strange] = [figure(10), figure(20), figure(20)];
  const leave = [
    followCursor("frequency", one.drawn, one.line),
    followCursor("frequency", other.drawn, other.line),
    followCursor("time", strange.drawn, strange.line),
  ];
  move(one.drawn, 100);
  expect(other.line.style).toMatchObject({ display: "block", left: "150px", height: "300px" });
  expect(one.line.style.display).toBe("");
  expect(strange.line.style.display).toBe("");
  move(one.drawn, 400); // beyond what the other shows
  expect(other.line.style.display).toBe("none");
  move(one.drawn, 100);
  one.drawn.dispatchEvent(new MouseEvent("mouseleave"));
  expect(other.line.style.display).toBe("none");
  leave.forEach((each) => {
    each();
  });
  move(one.drawn, 100);
  expect(other.line.style.display).toBe("none");
});

/** Drawings that follow data: each at most once per frame of the screen, and never too many in one. */

/** Time for drawings in a frame of 16.7 ms; the rest of them follows in the next. [ms] */
const BUDGET_MS = 6;

export interface DrawingQueue {
  /** Adds a drawing; returns how it is removed. */
  add: (draw: () => void) => () => void;
  /** Draws everything again, as soon as frames of the screen have time. */
  request: () => void;
  stop: () => void;
}

export function createDrawingQueue(): DrawingQueue {
  const drawings = new Set<() => void>();
  let due: (() => void)[] = [];
  let isStale = false;
  let frame = 0;
  const run = () => {
    frame = 0;
    const begun = performance.now();
    if (due.length === 0) {
      due = [...drawings];
      isStale = false;
    }
    do due.shift()?.();
    while (due.length > 0 && performance.now() - begun < BUDGET_MS);
    if (due.length > 0 || isStale) schedule();
  };
  const schedule = () => {
    if (frame === 0) frame = requestAnimationFrame(run);
  };
  return {
    add: (draw) => {
      drawings.add(draw);
      return () => {
        drawings.delete(draw);
        due = due.filter((one) => one !== draw);
      };
    },
    request: () => {
      isStale = true;
      schedule();
    },
    stop: () => {
      cancelAnimationFrame(frame);
      frame = 0;
    },
  };
}

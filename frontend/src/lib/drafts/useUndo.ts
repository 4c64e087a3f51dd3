import { useState } from "react";

const DEEPEST = 200;

/** A value that remembers what it was, so that a change can be taken back and made again. */
export function useUndo<T>(value: T, onChange: (value: T) => void) {
  const [past, setPast] = useState<T[]>([]);
  const [future, setFuture] = useState<T[]>([]);
  return {
    set: (next: T) => {
      setPast((all) => [...all.slice(-DEEPEST), value]);
      setFuture([]);
      onChange(next);
    },
    undo: () => {
      const before = past.at(-1);
      if (before === undefined) return;
      setPast(past.slice(0, -1));
      setFuture([value, ...future]);
      onChange(before);
    },
    redo: () => {
      const [next, ...rest] = future;
      if (next === undefined) return;
      setFuture(rest);
      setPast([...past, value]);
      onChange(next);
    },
    canUndo: past.length > 0,
    canRedo: future.length > 0,
  };
}

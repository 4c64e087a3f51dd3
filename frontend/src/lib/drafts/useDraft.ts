import { useEffect, useState } from "react";

/** Form state that survives a reload of the tab; discarded once it is sent. */
export function useDraft<T extends object>(key: string, initial: T) {
  const [draft, setDraft] = useState<T>(() => ({ ...initial, ...read<T>(key) }));
  useEffect(() => {
    sessionStorage.setItem(key, JSON.stringify(draft));
  }, [key, draft]);
  const discard = () => {
    sessionStorage.removeItem(key);
  };
  return { draft, setDraft, discard };
}

function read<T>(key: string): Partial<T> {
  try {
    const stored: unknown = JSON.parse(sessionStorage.getItem(key) ?? "{}");
    return typeof stored === "object" && stored !== null ? stored : {};
  } catch {
    return {}; // written by an older version of the page
  }
}

import { useEffect, useState } from "react";

/** Form state that survives a reload of this tab; forgotten once it is sent. */
export function useDraft<T extends object>(key: string, initial: T) {
  const [draft, setDraft] = useState<T>(() => ({ ...initial, ...read<T>(key) }));
  useEffect(() => {
    sessionStorage.setItem(key, JSON.stringify(draft));
  }, [key, draft]);
  const forget = () => {
    sessionStorage.removeItem(key);
  };
  return { draft, setDraft, forget };
}

function read<T>(key: string): Partial<T> {
  try {
    const kept: unknown = JSON.parse(sessionStorage.getItem(key) ?? "{}");
    return typeof kept === "object" && kept !== null ? kept : {};
  } catch {
    return {}; // written by an older version of the page
  }
}

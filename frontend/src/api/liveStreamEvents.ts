/** Events of one stream: states every second, and columns of its strip charts. */
import { address } from "./client";
import type { LiveSnapshot, StripColumns } from "./types";

interface Listener {
  /** The connection is there, again perhaps: what happened before was not heard. */
  onOpen: () => void;
  onSnapshot: (snapshot: LiveSnapshot) => void;
  onSamples: (columns: StripColumns) => void;
}

/** Listens to a stream; the browser connects again by itself. Returns how it stops. */
export function listenToStream(id: number, channels: string, to: Listener): () => void {
  const events = new EventSource(address("events", { stream_id: id, channels }));
  events.onopen = to.onOpen;
  events.addEventListener("live", (event: MessageEvent<string>) => {
    const snapshot = JSON.parse(event.data) as LiveSnapshot;
    if (snapshot.stream_id === id) to.onSnapshot(snapshot);
  });
  events.addEventListener("samples", (event: MessageEvent<string>) => {
    to.onSamples(JSON.parse(event.data) as StripColumns);
  });
  return () => {
    events.close();
  };
}

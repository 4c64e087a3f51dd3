/** Samples of a stream by channel, and who draws them. */
import { Strip } from "./strip";

/** Columns of several channels, as the server sends them. */
interface Columns {
  names: readonly string[];
  column_s: number;
  time_s: readonly number[];
  low: readonly (readonly (number | null)[])[];
  high: readonly (readonly (number | null)[])[];
}

export class Samples {
  private readonly strips = new Map<string, Strip>();
  private readonly listeners = new Set<() => void>();

  /** Last seconds of a channel; empty until samples of it arrive. */
  strip(channel: string): Strip {
    const known = this.strips.get(channel);
    if (known !== undefined) return known;
    const strip = new Strip();
    this.strips.set(channel, strip);
    return strip;
  }

  append({ names, time_s, column_s, low, high }: Columns): void {
    for (const [index, name] of names.entries()) {
      this.strip(name).append(time_s, column_s, low[index] ?? [], high[index] ?? []);
    }
    for (const listener of this.listeners) listener();
  }

  /** Calls after samples have been added; returns how it stops. */
  listen(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }
}

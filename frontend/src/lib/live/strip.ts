/** Samples of the last seconds of a channel, as the envelope that a strip chart draws. */

/** Time that a strip chart shows. [s] */
export const STRIP_S = 30;

/** Width of a bucket: about one pixel of a chart, and the length of a frame. [s] */
export const BUCKET_S = 0.05;
const BUCKETS = Math.round(STRIP_S / BUCKET_S);

type Row = readonly (number | null)[];

export type Envelope = [times: number[], low: (number | null)[], high: (number | null)[]];

/**
 * Lowest and highest sample of every bucket. Buckets stand at fixed times: extremes stay
 * visible and do not flicker while the chart moves, and memory does not grow with the record.
 */
export class Strip {
  private readonly low = new Float64Array(BUCKETS).fill(NaN);
  private readonly high = new Float64Array(BUCKETS).fill(NaN);
  private newest = Number.NEGATIVE_INFINITY;
  /** Middle of the newest samples. */
  last: number | null = null;

  /** Adds columns of this length [s], by the times of their beginnings [s]. */
  append(times: readonly number[], column_s: number, low: Row, high: Row): void {
    for (const [index, time] of times.entries()) {
      // Times are sums of fractions that are not exact.
      const first = Math.floor(time / BUCKET_S + 0.01);
      const end = Math.max(first + 1, Math.ceil((time + column_s) / BUCKET_S - 0.01));
      const [least, greatest] = [low[index] ?? null, high[index] ?? null];
      this.advance(end - 1);
      if (least === null || greatest === null) continue;
      if (end - 1 === this.newest) this.last = (least + greatest) / 2;
      for (let bucket = Math.max(first, this.newest - BUCKETS + 1); bucket < end; bucket++) {
        const slot = modulo(bucket);
        const [lowest = NaN, highest = NaN] = [this.low[slot], this.high[slot]];
        this.low[slot] = Number.isNaN(lowest) ? least : Math.min(lowest, least);
        this.high[slot] = Number.isNaN(highest) ? greatest : Math.max(highest, greatest);
      }
    }
  }

  private advance(bucket: number): void {
    if (bucket <= this.newest) return;
    const first = Math.max(this.newest + 1, bucket - BUCKETS + 1);
    for (let next = first; next <= bucket; next++) {
      this.low[modulo(next)] = this.high[modulo(next)] = NaN;
    }
    this.newest = bucket;
  }

  /** Middle of every bucket [s], its lowest and its highest sample; null where none is known. */
  envelope(): Envelope {
    const times: number[] = [];
    const low: (number | null)[] = [];
    const high: (number | null)[] = [];
    if (Number.isFinite(this.newest)) {
      for (let bucket = this.newest - BUCKETS + 1; bucket <= this.newest; bucket++) {
        const slot = modulo(bucket);
        const least = this.low[slot] ?? NaN;
        times.push((bucket + 0.5) * BUCKET_S);
        low.push(Number.isNaN(least) ? null : least);
        high.push(Number.isNaN(least) ? null : (this.high[slot] ?? null));
      }
    }
    return [times, low, high];
  }

  /** Time of the end of the newest bucket. [s] */
  get end_s(): number | null {
    return Number.isFinite(this.newest) ? (this.newest + 1) * BUCKET_S : null;
  }
}

/** An envelope in a unit of which a sample has `factor`. */
export function inUnit(envelope: Envelope, factor: number): Envelope {
  if (factor === 1) return envelope;
  const [times, low, high] = envelope;
  const scale = (value: number | null) => (value === null ? null : factor * value);
  return [times, low.map(scale), high.map(scale)];
}

const modulo = (bucket: number) => ((bucket % BUCKETS) + BUCKETS) % BUCKETS;

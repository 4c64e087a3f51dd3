/** A pole as frequency and damping, with first-order standard errors. */
interface PoleLike {
  real: number;
  imag: number;
  real_std?: number | null;
  imag_std?: number | null;
}

interface Oscillation {
  omega: number;
  omegaStd: number | null;
  damping: number;
  dampingStd: number | null;
}

/**
 * Natural frequency and damping ratio. Real and imaginary part are taken as
 * uncorrelated; for lightly damped poles their correlation enters in second order only.
 */
export function oscillation({ real, imag, real_std, imag_std }: PoleLike): Oscillation {
  const omega = Math.hypot(real, imag);
  const known = real_std != null && imag_std != null && omega > 0;
  return {
    omega,
    omegaStd: known ? Math.hypot(real * real_std, imag * imag_std) / omega : null,
    damping: omega > 0 ? -real / omega : 0,
    dampingStd: known
      ? Math.hypot(imag * imag * real_std, real * imag * imag_std) / omega ** 3
      : null,
  };
}

/** One pole of each conjugate pair, slowest first. */
export function upperHalf<P extends PoleLike>(poles: readonly P[]): P[] {
  return poles
    .filter((pole) => pole.imag >= 0)
    .sort((a, b) => Math.hypot(a.real, a.imag) - Math.hypot(b.real, b.imag));
}

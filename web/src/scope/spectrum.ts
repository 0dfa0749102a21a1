// The spectrum of a signal: a Hann window, a Fourier transform by powers of two, amplitudes of its sines.

export interface Spectrum { hz: number[]; amplitude: number[]; /** Hz between two values. */ step_hz: number }

const most_rows = 65_536;

/** Amplitudes of the last power of two of `column` that has no gap; null: it has fewer than 64 values in a row. */
export function spectrumOf(column: Float32Array, period_s: number): Spectrum | null {
  const rows = withoutGap(column);
  const size = 2 ** Math.floor(Math.log2(Math.min(rows.length, most_rows)));
  if (!(size >= 64)) return null;
  const newest = rows.subarray(rows.length - size);
  const mean = newest.reduce((all, value) => all + value, 0) / size;
  const real = Float64Array.from(newest, (value, row) => (value - mean) * (1 - Math.cos((2 * Math.PI * row) / size)) / 2);
  const imaginary = new Float64Array(size);
  transform(real, imaginary);
  const step_hz = 1 / (size * period_s);
  // The window takes half of each sine, and half of what is left lies at the negative frequencies.
  const amplitude = Array.from({ length: size / 2 }, (_, k) => (4 * Math.hypot(real[k] ?? 0, imaginary[k] ?? 0)) / size);
  return { hz: amplitude.map((_, k) => k * step_hz), amplitude, step_hz };
}

/** The longest run of values at the end of the column's longest stretch without a gap. */
function withoutGap(column: Float32Array): Float32Array {
  let [from, best, bestFrom] = [0, 0, 0];
  for (let row = 0; row <= column.length; row++) {
    if (row < column.length && !Number.isNaN(column[row])) continue;
    if (row - from > best) [best, bestFrom] = [row - from, from];
    from = row + 1;
  }
  return column.subarray(bestFrom, bestFrom + best);
}

/** In place; the length is a power of two. */
function transform(real: Float64Array, imaginary: Float64Array): void {
  const size = real.length;
  for (let row = 1, other = 0; row < size; row++) {
    let bit = size >> 1;
    for (; other & bit; bit >>= 1) other ^= bit;
    other ^= bit;
    if (row < other) {
      [real[row], real[other]] = [real[other] ?? 0, real[row] ?? 0];
      [imaginary[row], imaginary[other]] = [imaginary[other] ?? 0, imaginary[row] ?? 0];
    }
  }
  for (let half = 1; half < size; half *= 2) {
    for (let k = 0; k < half; k++) {
      const [cos, sin] = [Math.cos((Math.PI * k) / half), -Math.sin((Math.PI * k) / half)];
      for (let a = k; a < size; a += 2 * half) {
        const b = a + half;
        const re = cos * (real[b] ?? 0) - sin * (imaginary[b] ?? 0);
        const im = cos * (imaginary[b] ?? 0) + sin * (real[b] ?? 0);
        real[b] = (real[a] ?? 0) - re;
        imaginary[b] = (imaginary[a] ?? 0) - im;
        real[a] = (real[a] ?? 0) + re;
        imaginary[a] = (imaginary[a] ?? 0) + im;
      }
    }
  }
}

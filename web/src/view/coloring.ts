// How the path is coloured: by kind, or by what was measured of it and judged.
import type { Feature, Verdict } from '../control/model';
import type { Measured } from './measured';
import type { PathArrays } from './path';

export type Coloring = 'kind' | 'feed' | 'sync' | 'verdict';
/** `values` from least to most on the scale of colours; NaN is not measured. */
export interface Scale { values: Float32Array; least: number; most: number }

/** A feature lies this far from its place in the path at most, mm. */
const nearby_mm = 0.5;

/** For each pair the feature that was cut there, or null. `shift`: from machine to work coordinates, x and y. */
export function featuresOf(path: PathArrays, features: readonly Feature[], shift: readonly number[]): (Feature | null)[] {
  const ofLine = new Map<number, Feature[]>();
  for (const feature of features) ofLine.set(feature.line, [...(ofLine.get(feature.line) ?? []), feature]);
  return Array.from(path.lines, (line, pair) => {
    if (path.kinds[pair] === 'rapid') return null;
    const end = path.points.subarray(pair * 6 + 3, pair * 6 + 6);
    // The newest counts: a program that was started again has cut its holes again.
    return (ofLine.get(line) ?? []).findLast(({ position }) => !position
      || Math.hypot((position[0] ?? 0) + (shift[0] ?? 0) - (end[0] ?? 0), (position[1] ?? 0) + (shift[1] ?? 0) - (end[1] ?? 0)) < nearby_mm) ?? null;
  });
}

/** Magnitudes of the sync error: as it was judged at the servo rate where a feature is finished, else as the status had it. */
export function syncOf(measured: Measured, features: readonly (Feature | null)[]): Float32Array {
  return measured.sync.map((error, pair) => Math.abs(features[pair]?.sync_error_max_um ?? error));
}

export function scaleOf(values: Float32Array): Scale {
  let [least, most] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < least) least = value;
    if (value > most) most = value;
  }
  return { values, least, most };
}

/** 0 to 1 along the scale. */
export function share(scale: Scale, pair: number): number {
  const value = scale.values[pair] ?? NaN;
  return scale.most > scale.least ? (value - scale.least) / (scale.most - scale.least) : value - scale.least;
}

export const verdictsOf = (features: readonly (Feature | null)[]): (Verdict | null)[] => features.map((feature) => feature?.verdict ?? null);

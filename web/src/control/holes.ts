// The map of holes: each place of the program with the worst verdict of what was cut there.
import type { AxisStatus, Feature, Hole, Verdict } from './model';

export type MapVerdict = Verdict | 'none';
export interface MapHole { key: string; line: number; x: number; y: number; verdict: MapVerdict; done: number; of: number }
const rank: Record<MapVerdict, number> = { none: 0, good: 1, not_judged: 2, failed: 3 };
const keyOf = (at: readonly number[]) => `${(at[0] ?? 0).toFixed(2)} ${(at[1] ?? 0).toFixed(2)}`;

/** A feature lies where it was measured: this far from its place at most, mm. */
const nearby_mm = 0.5;

/** `shift`: from the machine coordinates of the features to those of the holes, x and y. */
export function mapOf(holes: Hole[], features: Feature[], shift: readonly [number, number] = [0, 0]) {
  const places = new Map<string, MapHole>();
  for (const hole of holes) {
    const key = keyOf(hole.at);
    const place = places.get(key);
    if (place) place.of += 1;
    else places.set(key, { key, line: hole.line, x: hole.at[0] ?? 0, y: hole.at[1] ?? 0, verdict: 'none', done: 0, of: 1 });
  }
  for (const feature of features) {
    const place = feature.position ? placeOf(places, (feature.position[0] ?? 0) + shift[0], (feature.position[1] ?? 0) + shift[1]) : null;
    if (!place) continue;
    place.done += 1;
    if (rank[feature.verdict] > rank[place.verdict]) place.verdict = feature.verdict;
  }
  const all = [...places.values()];
  const xs = all.map((hole) => hole.x);
  const ys = all.map((hole) => -hole.y);
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const size = Math.max(x1 - x0, y1 - y0, 10);
  const r = Math.max(size / 30, Math.min(size / 10, nearest(all) / 3));
  const pad = r * 1.8;
  const count = (verdict: MapVerdict) => all.filter((hole) => hole.verdict === verdict).length;
  const said = `${count('good')} good, ${count('failed')} out of tolerance, ${count('not_judged')} not judged, ${count('none')} to come`;
  return { holes: all, r, said, box: `${x0 - pad} ${y0 - pad} ${x1 - x0 + 2 * pad} ${y1 - y0 + 2 * pad}` };
}

function placeOf(places: Map<string, MapHole>, x: number, y: number): MapHole | null {
  const there = places.get(keyOf([x, y]));
  if (there) return there;
  for (const place of places.values()) if (Math.hypot(place.x - x, place.y - y) < nearby_mm) return place;
  return null;
}

function nearest(holes: MapHole[]): number {
  let least = Infinity;
  for (let i = 0; i < Math.min(holes.length, 400); i++) {
    for (let k = i + 1; k < Math.min(holes.length, 400); k++) {
      const [a, b] = [holes[i], holes[k]];
      if (a && b) least = Math.min(least, Math.hypot(a.x - b.x, a.y - b.y));
    }
  }
  return Number.isFinite(least) ? least : 30;
}

/** From machine coordinates to those of the work offset in force, of x and y. */
export function shiftOf(axes: readonly AxisStatus[]): [number, number] {
  const of = (letter: string) => {
    const axis = axes.find((axis) => axis.letter === letter);
    return axis ? Math.round((axis.work - axis.machine) * 1000) / 1000 : 0;
  };
  return [of('X'), of('Y')];
}

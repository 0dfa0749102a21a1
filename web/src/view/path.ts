// The tool path as arrays for the picture: pairs of points, each pair with the line it comes from.
import type { Segment } from '../control/model';

export interface PathArrays {
  /** x, y, z of both ends of each pair. */
  points: Float32Array;
  /** The line of each pair. */
  lines: Uint32Array;
  kinds: string[];
  least: [number, number, number];
  most: [number, number, number];
}

export function arraysOf(segments: Segment[]): PathArrays {
  const count = segments.reduce((all, segment) => all + Math.max(0, segment.points.length - 1), 0);
  const points = new Float32Array(count * 6);
  const lines = new Uint32Array(count);
  const kinds: string[] = new Array<string>(count);
  const least: PathArrays['least'] = [Infinity, Infinity, Infinity];
  const most: PathArrays['most'] = [-Infinity, -Infinity, -Infinity];
  let at = 0;
  for (const segment of segments) {
    for (let i = 1; i < segment.points.length; i++) {
      const ends = [segment.points[i - 1], segment.points[i]];
      ends.forEach((point, end) => {
        for (let axis = 0; axis < 3; axis++) {
          const value = point?.[axis] ?? 0;
          points[at * 6 + end * 3 + axis] = value;
          // Rapids from far away do not make the picture small.
          if (segment.kind === 'rapid') continue;
          least[axis] = Math.min(least[axis] ?? 0, value);
          most[axis] = Math.max(most[axis] ?? 0, value);
        }
      });
      lines[at] = segment.line;
      kinds[at] = segment.kind;
      at += 1;
    }
  }
  return { points, lines, kinds, least, most };
}

/** A pair that leads against the tool's motion counts as farther away by this, mm: the way out of a hole is not the way in. */
const against_motion = 0.05;

/**
 * Up to which pair the path is done: from `from` on, the next pair of `line` that passes nearest to the tool.
 * `motion`: how far the tool has moved along X, Y and Z of late, mm; 0: it stands.
 */
export function progress(path: PathArrays, from: number, line: number, tool: readonly number[], motion: readonly number[]): number {
  let best = from;
  let nearest = Infinity;
  let hasFound = false;
  for (let pair = from; pair < path.lines.length; pair++) {
    if (path.lines[pair] !== line) {
      // A line that is executed again comes later: only its next passage counts.
      if (hasFound) break;
      continue;
    }
    hasFound = true;
    const distance = toPair(path.points, pair, tool) + (leadsAgainst(path.points, pair, motion) ? against_motion : 0);
    if (distance < nearest) [nearest, best] = [distance, pair];
  }
  return best;
}

function leadsAgainst(points: Float32Array, pair: number, motion: readonly number[]): boolean {
  const along = (axis: number) => (points[pair * 6 + 3 + axis] ?? 0) - (points[pair * 6 + axis] ?? 0);
  return motion.reduce((sum, moved, axis) => sum + moved * along(axis), 0) < 0;
}

function toPair(points: Float32Array, pair: number, tool: readonly number[]): number {
  let along = 0;
  let length = 0;
  const delta: number[] = [];
  const offset: number[] = [];
  for (let axis = 0; axis < 3; axis++) {
    const a = points[pair * 6 + axis] ?? 0;
    delta[axis] = (points[pair * 6 + 3 + axis] ?? 0) - a;
    offset[axis] = (tool[axis] ?? 0) - a;
    along += (delta[axis] ?? 0) * (offset[axis] ?? 0);
    length += (delta[axis] ?? 0) ** 2;
  }
  const share = length > 0 ? Math.min(1, Math.max(0, along / length)) : 0;
  return Math.hypot(...offset.map((value, axis) => value - share * (delta[axis] ?? 0)));
}

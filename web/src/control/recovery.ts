// Whether a tool stands in the work with nothing under way that would bring it out, and what the control allows then.
import type { Hole, Status } from './model';
import { isUnderWay } from './needs';

export const isStuck = (status: Status) => status.is_tool_in_work && !isUnderWay(status);

export interface WayOut {
  /** What has to be done before; the key that does it. */
  first: 'release' | null;
  request: 'retract' | 'recover';
}

/** What a control before this one has left is recovered by its record. With its drives and without an alarm the control backs the tool out; else it recovers from what the encoders show. */
export function wayOut(status: Status): WayOut {
  const hasDrives = !status.left_in_work && status.power === 'ON' && status.is_ready && status.alarms.length === 0;
  return { first: status.emergency_stop === 'TRIGGERED' ? 'release' : null, request: hasDrives ? 'retract' : 'recover' };
}

/** The hole in which the tool stands: the nearest of the program's, within its tool. */
export function holeOf(status: Status, holes: Hole[]): Hole | null {
  const at = (letter: string) => status.axes.find((axis) => axis.letter === letter)?.work ?? 0;
  const distance = (hole: Hole) => Math.hypot((hole.at[0] ?? 0) - at('X'), (hole.at[1] ?? 0) - at('Y'));
  const nearest = holes.reduce<Hole | null>((best, hole) => (best === null || distance(hole) < distance(best) ? hole : best), null);
  return nearest && distance(nearest) < 1 ? nearest : null;
}

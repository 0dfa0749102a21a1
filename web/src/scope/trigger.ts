// When a record is taken: a signal crosses a level, or begins to have a value (a coupling is engaged), or an alarm comes, which
// the control says itself.
export type Edge = 'rising' | 'falling' | 'begins' | 'alarm';
export interface Trigger { signal: number; edge: Edge; level: number }

/** The first row at or after `from` where the trigger comes; null: not yet. */
export function triggerRow(column: Float32Array, from: number, trigger: Trigger): number | null {
  if (trigger.edge === 'alarm') return null;
  for (let row = Math.max(1, from); row < column.length; row++) {
    const before = column[row - 1] ?? NaN;
    const now = column[row] ?? NaN;
    if (trigger.edge === 'begins' ? Number.isNaN(before) && !Number.isNaN(now)
      : trigger.edge === 'rising' ? before < trigger.level && now >= trigger.level
      : before > trigger.level && now <= trigger.level) return row;
  }
  return null;
}

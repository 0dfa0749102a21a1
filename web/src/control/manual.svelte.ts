// What the operator has chosen for moves by hand.
import { inMillimetres, type DisplayUnit } from '../format/number';
import { machine } from './machine.svelte';
import { settings } from './settings.svelte';

export type ManualPane = 'jog' | 'handwheel' | 'mdi';

/** By hand no linear axis is faster, however fast its rapids are. */
const most_by_hand_mm_per_min = 10_000;

class Manual {
  pane = $state<ManualPane>('jog');
  /** Which of the steps; the first is continuous. */
  step = $state(0);
  /** Share of the jog speed, percent. */
  speed_percent = $state(30);
  /** Which of the steps a mark of the handwheel is. */
  wheel_step = $state(2);
  wheel_axis = $state('X');

  /** Speed of a continuous jog, mm/min or degrees/min. */
  speed(letter: string): number {
    const axis = machine.axis(letter);
    const most = axis?.unit === 'deg' ? axis.rapid_per_min : Math.min(axis?.rapid_per_min ?? 6000, most_by_hand_mm_per_min);
    return (most * this.speed_percent) / 100;
  }
}

export const manual = new Manual();
/** In the unit of the display, of rotary axes in degrees; 0 is continuous. */
export const steps: Record<DisplayUnit, readonly number[]> = { mm: [0, 0.001, 0.01, 0.1, 1, 10], inch: [0, 0.0001, 0.001, 0.01, 0.1, 1] };
/** Those that a mark of the handwheel can be. */
export const wheel_steps = [1, 2, 3] as const;

/** A step of an axis as the control is asked for it: mm, or degrees. */
export function stepOf(letter: string, step: number): number {
  return inMillimetres(steps[settings.unit][step] ?? 0, machine.axis(letter)?.unit ?? 'mm', settings.unit);
}

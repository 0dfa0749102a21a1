// What the operator has chosen for moves by hand.
import { machine } from './machine.svelte';

export type ManualPane = 'jog' | 'handwheel' | 'mdi';

class Manual {
  pane = $state<ManualPane>('jog');
  /** 0 is continuous, else the step in mm (degrees). */
  step = $state(0);
  /** Share of the jog speed, percent. */
  speed_percent = $state(30);
  /** A turn of one mark of the handwheel, mm. */
  wheel_step = $state(0.01);
  wheel_axis = $state('X');

  /** Speed of a continuous jog, mm/min. */
  speed(letter: string): number {
    const most = Math.min(machine.axis(letter)?.rapid_per_min ?? 6000, 10_000);
    return (most * this.speed_percent) / 100;
  }
}

export const manual = new Manual();
export const steps = [0, 0.001, 0.01, 0.1, 1, 10];

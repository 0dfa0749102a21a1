// What a jog key does, by the step that is chosen: a lease while it is held, or one step.
import { jogLease } from './jog.svelte';
import { machine } from './machine.svelte';
import { manual, stepOf } from './manual.svelte';
import { request } from './requests';

export function jog(letter: string, sign: string): void {
  const way = sign === '+' ? 1 : -1;
  if (manual.step === 0) {
    jogLease.start(letter + sign, { request: 'jog_continuous', axis: letter, ...machine.perMin(letter, way * manual.speed(letter)) });
  } else {
    void request('jog_increment', { axis: letter, ...machine.named('by', letter, way * stepOf(letter, manual.step)) });
  }
}

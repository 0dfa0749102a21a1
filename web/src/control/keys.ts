// The keyboard: each key and what it does. Letters act on the page Machine while no field is edited, and can be switched off.
import { control } from './control.svelte';
import { jogLease } from './jog.svelte';
import { jog } from './jogging';
import { manual } from './manual.svelte';
import { messages } from './messages.svelte';
import { isHeld, isUnderWay, waitsForConfirmation, whyNot } from './needs';
import { request } from './requests';
import { pageNames, route } from './route.svelte';
import { settings } from './settings.svelte';
import { keyTexts } from '../texts/en';

interface KeyAction { keys: string; says: string; act: () => void }

/** Asks, or says why it cannot be asked now. */
function ask(kind: string): void {
  const why = whyNot(kind, control.status, control.isLinked);
  if (why) messages.say('reason', why);
  else void request(kind);
}

function goOn(): void {
  const status = control.status;
  ask(status && waitsForConfirmation(status) ? 'confirm' : 'resume');
}

function power(): void {
  const on = control.status?.power !== 'ON';
  const why = whyNot('power', control.status, control.isLinked, on);
  if (why) messages.say('reason', why);
  else void request('power', { on });
}

function escape(): void {
  const status = control.status;
  if (jogLease.held) jogLease.stop();
  else if (status && isUnderWay(status) && !isHeld(status) && !waitsForConfirmation(status)) ask('feed_hold');
  else ask('stop');
}

export const actions: KeyAction[] = [
  { keys: 'F1', says: keyTexts.stopRequest, act: () => void request('emergency_stop', { on: true }) },
  { keys: 'F2', says: keyTexts.power, act: power },
  { keys: 'Escape', says: keyTexts.escape, act: escape },
  { keys: 'r', says: keyTexts.start, act: () => ask('start') },
  { keys: 'p', says: keyTexts.hold, act: () => ask('feed_hold') },
  { keys: 's', says: keyTexts.goOn, act: goOn },
  { keys: 'R', says: keyTexts.reset, act: () => ask('reset') },
  { keys: 'H', says: keyTexts.home, act: () => ask('home') },
  { keys: 'm', says: keyTexts.mdi, act: () => { manual.pane = 'mdi'; setTimeout(() => document.getElementById('mdi')?.focus()); } },
  { keys: 'j', says: keyTexts.jog, act: () => { manual.pane = 'jog'; } },
  ...pageNames.map((page, index) => ({ keys: String(index + 1), says: keyTexts.page(page), act: () => route.go(page) })),
];

/** Keys that jog while they are held. */
export const jogKeys: Record<string, string> = {
  ArrowLeft: 'X-', ArrowRight: 'X+', ArrowUp: 'Y+', ArrowDown: 'Y-', PageUp: 'Z+', PageDown: 'Z-',
};

/** The editor lives in a shadow root: what is edited there is only seen on the event's path. */
function isEdited(event: KeyboardEvent): boolean {
  const target = event.composedPath()[0] ?? null;
  return target instanceof HTMLElement && (target.closest('input, textarea, select, [role=slider], [role=radiogroup], .cm-editor') !== null);
}

/** Listens; `openKeys` shows the list of keys. */
export function listen(openKeys: () => void): void {
  addEventListener('keydown', (event) => {
    const isFunction = event.key === 'F1' || event.key === 'F2' || event.key === 'Escape';
    // A dialogue has its own keys; only the stop is above it.
    if (event.key !== 'F1' && document.querySelector('dialog[open]')) return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (!isFunction && (isEdited(event) || !settings.hasKeys)) return;
    if (event.key === '?') return openKeys();
    const jogged = jogKeys[event.key];
    if (jogged && route.page === 'machine' && manual.pane === 'jog' && !(event.target as HTMLElement).closest?.('.scroll, .lines, canvas')) {
      event.preventDefault();
      if (event.repeat || !control.status?.axes.some((axis) => axis.letter === jogged[0])) return;
      const why = whyNot('jog_continuous', control.status, control.isLinked);
      if (why) messages.say('reason', why);
      else jog(jogged.charAt(0), jogged.charAt(1));
      return;
    }
    const action = actions.find((action) => action.keys === event.key);
    const isLead = action !== undefined && !/^\d$/.test(action.keys) && !isFunction;
    if (!action || event.repeat || (isLead && route.page !== 'machine')) return;
    event.preventDefault();
    action.act();
  });
  addEventListener('keyup', (event) => {
    if (jogKeys[event.key]) jogLease.stop();
  });
}

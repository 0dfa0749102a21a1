// Why a key cannot be used now: what the control says of its requests' needs, so that a key says it before it is asked.
import { t } from '../texts/en';
import { machine } from './machine.svelte';
import type { Status } from './model';

const lacks = (need: string, status: Status) => status.unmet.find((unmet) => unmet.need === need);

export const isUnderWay = (status: Status) => !lacks('program_under_way', status);
export const waitsForConfirmation = (status: Status) => !lacks('program_waits_for_confirmation', status);
export const isHeld = (status: Status) => status.execution === 'FEED_HOLD' || status.execution === 'INTERRUPTED';

/** The reason why `request` would be refused, or null; `on`: of one that switches something, which way. */
export function whyNot(request: string, status: Status | null, isLinked: boolean, on = true): string | null {
  if (!isLinked || !status) return t.noLink;
  const known = machine.facts?.requests.find((entry) => entry.request === request && (entry.on ?? on) === on);
  for (const need of known?.needs ?? []) {
    const unmet = lacks(need, status);
    if (unmet) return [unmet.reason, unmet.remedy].filter(Boolean).join(': ');
  }
  return null;
}

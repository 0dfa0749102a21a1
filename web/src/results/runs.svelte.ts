// The history of runs: what is looked for, what was found, and the two that are looked at.
import { get } from '../control/api';
import { messages } from '../control/messages.svelte';
import type { Run, RunDetail, Runs, RunTrace, Verdict } from '../control/model';
import { sentenceOf } from '../control/requests';

class History {
  program = $state('');
  verdict = $state<'' | Verdict>('');
  runs = $state.raw<Run[]>([]);
  isShortened = $state(false);
  isKept = $state(true);
  isLoaded = $state(false);

  async load(): Promise<void> {
    const asked = new URLSearchParams();
    if (this.program.trim()) asked.set('program', this.program.trim());
    if (this.verdict) asked.set('verdict', this.verdict);
    const found = await get<Runs>(`/runs?${asked}`).catch(() => null);
    if (!found) return; // the bar says that there is no connection
    [this.runs, this.isShortened, this.isKept, this.isLoaded] = [found.runs, found.is_shortened, found.is_kept, true];
  }
}

export const history = new History();

export async function detailOf(id: string): Promise<RunDetail | null> {
  return get<RunDetail>(`/runs/${encodeURIComponent(id)}`).catch((error: unknown) => (messages.say('refused', sentenceOf(error)), null));
}

export interface Span { from_s: number; to_s: number }

/** So many columns of a trace; null: it has none, or the control says why not. */
export async function traceOf(id: string, signals: string[], span: Span | null): Promise<RunTrace | null> {
  const asked = new URLSearchParams({ signals: signals.join(','), columns: '1200' });
  if (span) { asked.set('from_s', String(span.from_s)); asked.set('to_s', String(span.to_s)); }
  return get<RunTrace>(`/runs/${encodeURIComponent(id)}/trace?${asked}`).catch((error: unknown) => (messages.say('refused', sentenceOf(error)), null));
}

export interface Line { times: number[]; values: (number | null)[] }

/** The least and the greatest of each column, one after the other, so that no peak is lost. */
export function lineOf(trace: RunTrace | null, signal: string): Line | null {
  const found = trace?.signals.find((one) => one.name === signal);
  if (!trace || !found) return null;
  const half_s = (trace.to_s - trace.from_s) / trace.time_s.length / 2;
  const times = trace.time_s.flatMap((time) => [time, time + half_s]);
  const values = found.least.flatMap((least, index) => [least, found.most[index] ?? null]);
  return { times, values };
}

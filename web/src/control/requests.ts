// What the operator asks of the control. What it refuses is said in its own words.
import { Refused, send } from './api';
import { messages } from './messages.svelte';
import { t } from '../texts/en';

export interface Request { request: string; [field: string]: unknown }
interface Accepted { accepted: true; notes: string[] }

/** Asks, and says what the control answers; true: it was accepted. */
export async function request(kind: string, fields: Record<string, unknown> = {}): Promise<boolean> {
  try {
    const answer = await send<Accepted>('/request', { request: kind, ...fields });
    if (answer.notes.length > 0) messages.say('note', answer.notes.join(' '));
    return true;
  } catch (error) {
    messages.say('refused', sentenceOf(error));
    return false;
  }
}

export function sentenceOf(error: unknown): string {
  if (error instanceof Refused) return [error.message, error.remedy].filter(Boolean).join(' ');
  return t.noAnswer;
}

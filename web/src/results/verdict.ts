// How a verdict looks: a tone and a sign, never colour alone.
import type { Feature, Verdict } from '../control/model';
import { plain, signed } from '../format/number';

export const tone: Record<Verdict, string> = { good: 'green', failed: 'red', not_judged: '' };
export const sign: Record<Verdict, string> = { good: '✓', failed: '✕', not_judged: '?' };
export const verdicts: Verdict[] = ['good', 'failed', 'not_judged'];

/** A measure of a feature as text; empty where its kind has not got it. */
export function measure(feature: Feature, name: keyof Feature, decimals: number, isSigned = false): string {
  const value = feature[name];
  return typeof value === 'number' ? (isSigned ? signed : plain)(value, decimals) : '';
}

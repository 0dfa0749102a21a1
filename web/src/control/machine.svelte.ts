// What the machine is: axes with their travel, ranges of the overrides, the stock. Asked for once a connection.
import { get } from './api';
import type { Machine, MachineAxis } from './model';

class MachineFacts {
  facts = $state.raw<Machine | null>(null);

  async load(): Promise<void> {
    this.facts = await get<Machine>('/machine').catch(() => this.facts);
  }

  axis(letter: string): MachineAxis | undefined {
    return this.facts?.axes.find((axis) => axis.letter === letter);
  }

  /** A coordinate of an axis as a request names it: `by_mm` of a linear axis, `by_deg` of a rotary one. */
  named(what: 'by' | 'at', letter: string, value: number): Record<string, number> {
    return { [`${what}_${this.axis(letter)?.unit ?? 'mm'}`]: value };
  }

  /** A speed of an axis as a request names it: `mm_per_min` or `deg_per_min`. */
  perMin(letter: string, value: number): Record<string, number> {
    return { [`${this.axis(letter)?.unit ?? 'mm'}_per_min`]: value };
  }

  range(what: 'feed' | 'rapid' | 'spindle'): { least: number; most: number } {
    const overrides = this.facts?.overrides;
    if (!overrides) return { least: what === 'spindle' ? 50 : 0, most: what === 'spindle' ? 120 : what === 'feed' ? 200 : 100 };
    const of = overrides[what];
    return { least: of.least_percent, most: of.most_percent };
  }
}

export const machine = new MachineFacts();

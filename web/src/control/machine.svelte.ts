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

  range(what: 'feed' | 'rapid' | 'spindle'): { least: number; most: number } {
    const overrides = this.facts?.overrides;
    if (!overrides) return { least: what === 'spindle' ? 50 : 0, most: what === 'spindle' ? 120 : what === 'feed' ? 200 : 100 };
    const of = overrides[what];
    return { least: of.least_percent, most: of.most_percent };
  }
}

export const machine = new MachineFacts();

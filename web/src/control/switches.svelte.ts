// The switches of the panel: single block, optional stop, block skip. The status says how they are.
import type { Status } from './model';
import type { ServerMessage } from './control.svelte';
import { request } from './requests';

const requestOf = { single: 'single_block', optional: 'optional_stop', skip: 'block_skip' } as const;

class Switches {
  single = $state(false);
  optional = $state(false);
  skip = $state(false);

  /** They are as the control says, in whichever tab they were set. */
  take(message: ServerMessage): void {
    const said = (message.status as Partial<Status> | undefined)?.switches;
    if (!said) return;
    this.single = said.single_block;
    this.optional = said.optional_stop;
    this.skip = said.block_skip.includes(1);
  }

  async set(which: keyof typeof requestOf, on: boolean): Promise<void> {
    const fields = which === 'skip' ? { level: 1, on } : { on };
    await request(requestOf[which], fields);
  }
}

export const switches = new Switches();

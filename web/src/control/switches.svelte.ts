// The switches of the panel: single block, optional stop, block skip. The status leads where it has them.
import type { ServerMessage } from './control.svelte';
import { request } from './requests';

const requestOf = { single: 'single_block', optional: 'optional_stop', skip: 'block_skip' } as const;

class Switches {
  single = $state(false);
  optional = $state(false);
  skip = $state(false);

  /** A control that was started anew has them off; where its status says how they are, that counts. */
  take(message: ServerMessage): void {
    const said = message.status as { is_single_block?: boolean; is_optional_stop?: boolean } | undefined;
    if (said?.is_single_block !== undefined) this.single = said.is_single_block;
    if (said?.is_optional_stop !== undefined) this.optional = said.is_optional_stop;
  }

  async set(which: keyof typeof requestOf, on: boolean): Promise<void> {
    const fields = which === 'skip' ? { level: 1, on } : { on };
    if (await request(requestOf[which], fields)) this[which] = on;
  }
}

export const switches = new Switches();

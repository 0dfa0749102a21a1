// The switches of the panel: single block, optional stop, block skip. The status leads where it has them.
import { request } from './requests';

const requestOf = { single: 'single_block', optional: 'optional_stop', skip: 'block_skip' } as const;

class Switches {
  single = $state(false);
  optional = $state(false);
  skip = $state(false);

  async set(which: keyof typeof requestOf, on: boolean): Promise<void> {
    const fields = which === 'skip' ? { level: 1, on } : { on };
    if (await request(requestOf[which], fields)) this[which] = on;
  }
}

export const switches = new Switches();

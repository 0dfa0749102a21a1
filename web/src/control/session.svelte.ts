// Who this page is to the control, and who commands the machine.
import { asSession, Refused, send } from './api';
import type { ServerMessage } from './control.svelte';
import { messages } from './messages.svelte';
import { sentenceOf } from './requests';

interface Opened { session: string; name: string; role: 'operator' | 'viewer'; commands: boolean }
const kept = 'leadscrew.name';

function ownName(): string {
  const name = sessionStorage.getItem(kept) ?? `page-${Math.floor(100 + Math.random() * 900)}`;
  sessionStorage.setItem(kept, name);
  return name;
}

class Session {
  name = $state('');
  role = $state<'operator' | 'viewer'>('operator');
  holder = $state<string | null>(null);
  askedBy = $state<string | null>(null);

  /** Opens a session; again after the server was gone. False: it does not answer. */
  async open(): Promise<boolean> {
    try {
      const opened = await send<Opened>('/session', { name: ownName() });
      asSession(opened.session);
      this.name = opened.name;
      this.role = opened.role;
      return true;
    } catch (error) {
      asSession(null);
      return error instanceof Refused && error.status === 404;
    }
  }

  take(message: ServerMessage): void {
    if (message.type !== 'operator') return;
    this.holder = (message.holder as string | null) ?? null;
    this.askedBy = (message.asked_by as string | null) ?? null;
  }

  get isHolder(): boolean {
    return this.holder !== null && this.holder === this.name;
  }

  /** Another session commands the machine. */
  get isWatching(): boolean {
    return this.role === 'viewer' || (this.holder !== null && this.holder !== this.name);
  }

  async operator(act: 'ask' | 'grant' | 'keep' | 'release'): Promise<void> {
    await send('/operator', { do: act }).catch((error: unknown) => messages.say('refused', sentenceOf(error)));
  }
}

export const session = new Session();

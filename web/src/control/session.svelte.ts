// Who this page is to the control, and who commands the machine.
import { asSession, get, Refused, send } from './api';
import type { ServerMessage } from './control.svelte';
import { messages } from './messages.svelte';
import { sentenceOf } from './requests';

interface Opened { session: string; name: string; role: 'operator' | 'viewer' }
const keptAs = 'leadscrew.session';

function kept(): Opened | null {
  try {
    return JSON.parse(sessionStorage.getItem(keptAs) ?? 'null') as Opened | null;
  } catch {
    return null;
  }
}

class Session {
  name = $state('');
  role = $state<'operator' | 'viewer'>('operator');
  holder = $state<string | null>(null);
  askedBy = $state<string | null>(null);
  /** The server asks for a token: it listens beyond this computer. */
  needsToken = $state(false);
  #token: string | null = null;

  /** Goes on with the session of this tab, which has outlived a reload, or opens one. False: there is none. */
  async open(): Promise<boolean> {
    const old = kept();
    try {
      const opened = (await this.#goOn(old)) ?? (await send<Opened>('/session', { name: old?.name ?? `page-${Math.floor(100 + Math.random() * 900)}`, ...(this.#token ? { token: this.#token } : {}) }));
      asSession(opened.session);
      sessionStorage.setItem(keptAs, JSON.stringify(opened));
      this.name = opened.name;
      this.role = opened.role;
      this.needsToken = false;
      return true;
    } catch (error) {
      this.needsToken = error instanceof Refused && error.status === 401;
      if (this.needsToken && this.#token) messages.say('refused', sentenceOf(error));
      return false;
    }
  }

  async #goOn(old: Opened | null): Promise<Opened | null> {
    if (!old) return null;
    asSession(old.session);
    try {
      await get('/operator');
      return old;
    } catch (error) {
      if (!(error instanceof Refused)) throw error;
      asSession(null);
      return null;
    }
  }

  /** With this token from now on. */
  use(token: string): void {
    this.#token = token;
    this.needsToken = false;
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

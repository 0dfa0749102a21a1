// A jog as long as its key is pressed. The lease is the control's: the page renews it, and stops renewing at the first doubt.
import { send } from './api';
import { messages } from './messages.svelte';
import { sentenceOf } from './requests';

const renewal_ms = 70;
/** An answer that is later than this ends the jog: renewals must not queue up behind a slow line. */
const latest_ms = 150;

class JogLease {
  /** The key that is pressed now, `X+`. */
  held = $state<string | null>(null);
  #timer: ReturnType<typeof setTimeout> | undefined;
  #turn = 0;

  constructor() {
    const stop = () => this.stop();
    for (const event of ['blur', 'pagehide', 'pointerup', 'pointercancel', 'contextmenu']) addEventListener(event, stop);
    document.addEventListener('visibilitychange', stop);
  }

  /** Begins `body`, a request that is a lease, and renews it until `stop`. */
  start(key: string, body: Record<string, unknown>): void {
    if (this.held) this.stop();
    this.held = key;
    this.#turn += 1;
    void this.#renew(body, this.#turn);
  }

  async #renew(body: Record<string, unknown>, turn: number): Promise<void> {
    const begun = performance.now();
    try {
      await send('/request', body, AbortSignal.timeout(latest_ms));
    } catch (error) {
      if (turn !== this.#turn) return;
      messages.say('refused', sentenceOf(error));
      return this.stop();
    }
    if (turn !== this.#turn || !this.held) return;
    const pause = Math.max(0, renewal_ms - (performance.now() - begun));
    this.#timer = setTimeout(() => void this.#renew(body, turn), pause);
  }

  stop(): void {
    if (!this.held) return;
    this.held = null;
    this.#turn += 1;
    clearTimeout(this.#timer);
    void send('/request', { request: 'jog_stop' }).catch(() => undefined);
  }
}

export const jogLease = new JogLease();

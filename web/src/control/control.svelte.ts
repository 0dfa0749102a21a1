// The control as this page last saw it: status by WebSocket, with its age. Never a source of truth.
import type { Status } from './model';
import { socketAddress } from './api';

const old_ms = 500;
const again_ms = 500;

export type Link = 'connecting' | 'open' | 'lost';
type Listener = (message: ServerMessage) => void;
export interface ServerMessage { type: string; [field: string]: unknown }

class Control {
  status = $state.raw<Status | null>(null);
  link = $state<Link>('connecting');
  /** Seconds since the last status; 0 while it is fresh. */
  age_s = $state(0);
  #last_ms = 0;
  #socket: WebSocket | null = null;
  #listeners = new Set<Listener>();
  #opened = new Set<() => void>();
  #scope = new Set<(data: ArrayBuffer) => void>();

  /** Connects, and again whenever the connection is gone; `before` opens the session. */
  async connect(before: () => Promise<boolean>): Promise<void> {
    if (!(await before())) {
      this.link = 'lost';
      setTimeout(() => void this.connect(before), again_ms);
      return;
    }
    const socket = new WebSocket(socketAddress());
    socket.binaryType = 'arraybuffer';
    this.#socket = socket;
    socket.onopen = () => {
      this.link = 'open';
      for (const listener of this.#opened) listener();
    };
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
      if (typeof event.data === 'string') this.take(JSON.parse(event.data) as ServerMessage);
      else for (const listener of this.#scope) listener(event.data);
    };
    socket.onclose = () => {
      this.link = 'lost';
      setTimeout(() => void this.connect(before), again_ms);
    };
  }

  watch(): void {
    setInterval(() => {
      const late = performance.now() - this.#last_ms;
      this.age_s = this.#last_ms > 0 && late > old_ms ? late / 1000 : 0;
    }, 100);
  }

  /** A message of the server. */
  take(message: ServerMessage): void {
    if (message.type === 'status' || message.type === 'delta') this.#last_ms = performance.now();
    if (!this.status) performance.mark('digits');
    if (message.type === 'status') this.status = message.status as Status;
    else if (message.type === 'delta' && this.status) this.status = { ...this.status, ...(message.status as Partial<Status>) };
    for (const listener of this.#listeners) listener(message);
  }

  on(listener: Listener): () => void {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  /** Each time the connection is there. */
  onOpen(listener: () => void): void {
    this.#opened.add(listener);
  }

  onScope(listener: (data: ArrayBuffer) => void): () => void {
    this.#scope.add(listener);
    return () => this.#scope.delete(listener);
  }

  tell(message: unknown): void {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(message));
  }

  get isLinked(): boolean {
    return this.link === 'open' && this.age_s === 0;
  }
}

export const control = new Control();

// What the page has to say to the operator: one line, and the one polite live region of the page.
export type MessageKind = 'reason' | 'note' | 'refused';
export interface Message { kind: MessageKind; text: string; id: number }

const shown_ms = 9000;

class Messages {
  current = $state<Message | null>(null);
  /** What a screen reader is told. */
  told = $state('');
  #timer: ReturnType<typeof setTimeout> | undefined;
  #count = 0;

  say(kind: MessageKind, text: string): void {
    const sentence = text.charAt(0).toUpperCase() + text.slice(1);
    this.#count += 1;
    this.current = { kind, text: sentence, id: this.#count };
    this.tell(sentence);
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => (this.current = null), shown_ms);
  }

  /** Only to screen readers. */
  tell(text: string): void {
    this.told = text === this.told ? `${text}\u00a0` : text;
  }

  close(): void {
    this.current = null;
  }
}

export const messages = new Messages();

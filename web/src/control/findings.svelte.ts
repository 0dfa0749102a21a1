// What the control found wrong with a program, by its name.
import type { Finding } from './model';

class Findings {
  #of = $state.raw<Record<string, Finding[]>>({});

  set(name: string, findings: Finding[]): void {
    this.#of = { ...this.#of, [name]: findings };
  }

  of(name: string): Finding[] {
    return this.#of[name] ?? [];
  }
}

export const findings = new Findings();

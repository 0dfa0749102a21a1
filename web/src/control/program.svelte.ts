// The program that the control has: its text, its path and its holes. Asked for when its name changes.
import { get } from './api';
import type { Program, Tool } from './model';

class LoadedProgram {
  program = $state.raw<Program | null>(null);
  lines = $derived(this.program?.text.split('\n') ?? []);
  /** The line that the operator looks at, chosen in the view or in the text. */
  chosen = $state<number | null>(null);
  tools = $state.raw<Tool[]>([]);
  #name: string | null = null;

  show(program: Program): void {
    this.#name = program.name;
    this.program = program;
  }

  /** Of the tool in the spindle, mm, as the tool table has it. */
  toolDiameter(tool: number): number {
    return this.tools.find((entry) => entry.number === tool)?.diameter_mm ?? 6;
  }

  /** Asks again for all: the connection was gone, or the program was saved. */
  async refresh(): Promise<void> {
    this.tools = await get<Tool[]>('/tools').catch(() => this.tools);
    if (this.#name !== null) await this.load(this.#name, true);
  }

  async load(name: string | null, isForced = false): Promise<void> {
    if ((name === this.#name && !isForced) || name === 'MDI') return;
    this.#name = name;
    this.chosen = null;
    if (name === null) {
      this.program = null;
      return;
    }
    const answer = await get<Program | null>('/program').catch(() => null);
    if (name === this.#name) this.program = answer;
  }
}

export const loaded = new LoadedProgram();

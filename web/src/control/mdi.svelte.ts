// Typed blocks and the last of them, the newest first; kept by this browser.
import { request } from './requests';

const kept = 'leadscrew.mdi';
const most = 30;

class Mdi {
  history = $state<string[]>([]);

  constructor() {
    try {
      this.history = JSON.parse(localStorage.getItem(kept) ?? '[]') as string[];
    } catch {
      this.history = [];
    }
  }

  async execute(blocks: string): Promise<boolean> {
    const isAccepted = await request('manual_data_input', { blocks });
    this.history = [blocks, ...this.history.filter((block) => block !== blocks)].slice(0, most);
    localStorage.setItem(kept, JSON.stringify(this.history));
    return isAccepted;
  }
}

export const mdi = new Mdi();

// How this browser shows things: of no concern to the control.
import type { DisplayUnit } from '../format/number';

export type Theme = 'auto' | 'light' | 'dark';
const kept = 'leadscrew.display';

interface Kept { unit: DisplayUnit; theme: Theme; hasKeys: boolean }

function read(): Kept {
  const standard: Kept = { unit: 'mm', theme: 'auto', hasKeys: true };
  try {
    return { ...standard, ...(JSON.parse(localStorage.getItem(kept) ?? '{}') as Partial<Kept>) };
  } catch {
    return standard;
  }
}

class Settings {
  unit = $state<DisplayUnit>('mm');
  theme = $state<Theme>('auto');
  /** Single keys lead the machine page. */
  hasKeys = $state(true);
  isDark = $state(false);

  constructor() {
    Object.assign(this, read());
    const dark = matchMedia('(prefers-color-scheme: dark)');
    dark.addEventListener('change', () => this.show(dark.matches));
    this.show(dark.matches);
  }

  set(change: Partial<Kept>): void {
    Object.assign(this, change);
    const { unit, theme, hasKeys } = this;
    localStorage.setItem(kept, JSON.stringify({ unit, theme, hasKeys }));
    this.show(matchMedia('(prefers-color-scheme: dark)').matches);
  }

  private show(isSystemDark: boolean): void {
    this.isDark = this.theme === 'dark' || (this.theme === 'auto' && isSystemDark);
    document.documentElement.dataset.theme = this.isDark ? 'dark' : 'light';
  }
}

export const settings = new Settings();

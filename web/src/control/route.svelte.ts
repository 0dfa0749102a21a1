// Which page is shown: the address says it, so that a page can be kept, shared and reloaded.
import { pages } from '../texts/en';

export type PageName = keyof typeof pages;
export const pageNames = Object.keys(pages) as PageName[];

const read = (): PageName => {
  const name = location.hash.slice(1).split('/')[0] as PageName;
  return pageNames.includes(name) ? name : 'machine';
};

const parts = (): string[] => location.hash.slice(1).split('/').map(decoded);

function decoded(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

class Route {
  page = $state<PageName>(read());
  #parts = $state.raw<string[]>(parts());

  constructor() {
    addEventListener('hashchange', () => ([this.page, this.#parts] = [read(), parts()]));
  }

  /** What stands behind the page's name: `#results/runs/17` has "runs" at 1. */
  part(index: number): string {
    return this.#parts[index] ?? '';
  }

  go(page: PageName, ...behind: string[]): void {
    location.hash = [page, ...behind.filter((part) => part !== '').map(encodeURIComponent)].join('/');
  }
}

export const route = new Route();

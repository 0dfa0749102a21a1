// Which page is shown: the address says it, so that a page can be kept, shared and reloaded.
import { pages } from '../texts/en';

export type PageName = keyof typeof pages;
export const pageNames = Object.keys(pages) as PageName[];

const read = (): PageName => {
  const name = location.hash.slice(1).split('/')[0] as PageName;
  return pageNames.includes(name) ? name : 'machine';
};

class Route {
  page = $state<PageName>(read());

  constructor() {
    addEventListener('hashchange', () => (this.page = read()));
  }

  go(page: PageName): void {
    location.hash = page;
  }
}

export const route = new Route();

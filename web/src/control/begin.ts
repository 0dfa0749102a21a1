// What happens when the page is opened: it connects, and asks for what the status does not carry.
import { alarms } from './alarms.svelte';
import { control } from './control.svelte';
import { cut } from './cut.svelte';
import { machine } from './machine.svelte';

export async function begin(): Promise<void> {
  control.watch();
  control.on((message) => cut.take(message));
  if (import.meta.env.DEV && new URLSearchParams(location.search).has('mock')) {
    const { mock } = await import('../dev/mock');
    return mock();
  }
  control.onOpen(() => {
    void machine.load();
    void alarms.load();
  });
  control.connect();
}

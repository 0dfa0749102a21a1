// What happens when the page is opened: it connects, and asks for what the status does not carry.
import { alarms } from './alarms.svelte';
import { control } from './control.svelte';
import { cut } from './cut.svelte';
import { messages } from './messages.svelte';
import { loaded } from './program.svelte';
import { session } from './session.svelte';
import { switches } from './switches.svelte';
import { machine } from './machine.svelte';
import { follow } from './trace.svelte';

export async function begin(): Promise<void> {
  control.watch();
  control.on((message) => cut.take(message));
  control.on((message) => session.take(message));
  control.on(follow);
  control.on((message) => {
    if (message.type !== 'event') return;
    if (message.event === 'notice') messages.say('note', String(message.text));
    if (message.event === 'alarm') void alarms.load();
  });
  control.on((message) => switches.take(message));
  if (import.meta.env.DEV && new URLSearchParams(location.search).has('mock')) {
    const { mock } = await import('../dev/mock');
    return mock();
  }
  control.onOpen(() => {
    void machine.load();
    void alarms.load();
    void loaded.refresh();
    void cut.load();
  });
  void control.connect(() => session.open());
}

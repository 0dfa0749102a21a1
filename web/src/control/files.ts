// Programs in the control's folder: load, upload.
import { put, Refused, send } from './api';
import { findings } from './findings.svelte';
import { messages } from './messages.svelte';
import { sentenceOf } from './requests';
import { t } from '../texts/en';

/** Loads a program; what the control finds wrong with it is kept with its name. */
export async function loadProgram(name: string): Promise<boolean> {
  try {
    const { notes } = await send<{ notes: string[] }>('/request', { request: 'load', program: name });
    if (notes.length > 0) messages.say('note', notes.join(' '));
    findings.set(name, []);
    return true;
  } catch (error) {
    findings.set(name, error instanceof Refused ? error.findings : []);
    messages.say('refused', sentenceOf(error));
    return false;
  }
}

export async function saveProgram(name: string, text: string): Promise<boolean> {
  try {
    await put(`/programs/${name.split('/').map(encodeURIComponent).join('/')}`, text);
    return true;
  } catch (error) {
    messages.say('refused', sentenceOf(error));
    return false;
  }
}

/** A file that was dropped is put into the folder of programs, and loaded. */
export async function dropProgram(event: DragEvent): Promise<void> {
  event.preventDefault();
  const file = event.dataTransfer?.files[0];
  if (file && (await saveProgram(file.name, await file.text())) && (await loadProgram(file.name))) {
    messages.say('note', t.loadedFile(file.name));
  }
}

/** The programs in the order of their names. */
export function byName<T extends { path: string }>(entries: T[]): T[] {
  return [...entries].sort((a, b) => a.path.localeCompare(b.path));
}

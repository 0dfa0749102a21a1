// Programs in the control's folder: load, upload.
import { put } from './api';
import { messages } from './messages.svelte';
import { request, sentenceOf } from './requests';
import { t } from '../texts/en';

export async function loadProgram(name: string): Promise<boolean> {
  return request('load', { program: name });
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
  if (file && (await saveProgram(file.name, await file.text()))) {
    if (await loadProgram(file.name)) messages.say('note', t.loadedFile(file.name));
  }
}

// Programs in the control's folder: load, upload.
import { getVersion, put, Refused, send } from './api';
import { findings } from './findings.svelte';
import { messages } from './messages.svelte';
import { sentenceOf } from './requests';
import { t } from '../texts/en';

/** Loads a program, as one for another dialect than the machine's if that is named; what the control finds wrong with it is kept with its name. */
export async function loadProgram(name: string, dialect?: string): Promise<boolean> {
  try {
    const { notes } = await send<{ notes: string[] }>('/request', { request: 'load', program: name, ...(dialect ? { dialect } : {}) });
    if (notes.length > 0) messages.say('note', notes.join(' '));
    findings.set(name, []);
    return true;
  } catch (error) {
    findings.set(name, error instanceof Refused ? error.findings : []);
    messages.say('refused', sentenceOf(error));
    return false;
  }
}

/** The versions of programs that were read or written last: what is saved replaces these and no others. */
const versions = new Map<string, string | null>();

const address = (name: string) => `/programs/${name.split('/').map(encodeURIComponent).join('/')}`;

export async function readProgram(name: string): Promise<string> {
  const { text, version } = await getVersion(address(name));
  versions.set(name, version);
  return text;
}

/** Saves a program; `isNew`: a file from elsewhere. What would replace another version than the one that was read is asked for. */
export async function saveProgram(name: string, text: string, isNew = false): Promise<boolean> {
  const save = async (replaces: string | null) => { versions.set(name, await put(address(name), text, replaces)); };
  try {
    await save(isNew ? null : (versions.get(name) ?? null)).catch(async (error: unknown) => {
      if (!isOfAnother(error) || !confirm(t.replaces(error.message))) throw error;
      await save('*');
    });
    return true;
  } catch (error) {
    messages.say('refused', sentenceOf(error));
    return false;
  }
}

/** Refused because another version is there. */
function isOfAnother(error: unknown): error is Refused {
  return error instanceof Refused && error.status === 409 && error.remedy?.includes('If-Match') === true;
}

/** A file that was dropped is put into the folder of programs, and loaded. */
export async function dropProgram(event: DragEvent): Promise<void> {
  event.preventDefault();
  const file = event.dataTransfer?.files[0];
  if (file && (await saveProgram(file.name, await file.text(), true)) && (await loadProgram(file.name))) {
    messages.say('note', t.loadedFile(file.name));
  }
}

/** The programs in the order of their names. */
export function byName<T extends { path: string }>(entries: T[]): T[] {
  return [...entries].sort((a, b) => a.path.localeCompare(b.path));
}

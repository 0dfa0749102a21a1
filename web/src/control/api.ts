// The addresses of the control. The page uses nothing else of it.
import type { Finding } from './model';

const base = '/api/v1';

/** An answer that is no success: the control's own sentence. */
export class Refused extends Error {
  constructor(message: string, readonly remedy: string | null = null, readonly status = 0,
    readonly findings: Finding[] = []) {
    super(message);
  }
}

async function sentence(response: Response): Promise<Refused> {
  const text = await response.text();
  try {
    const body = JSON.parse(text) as { reason?: string; remedy?: string | null; findings?: Finding[] };
    return new Refused(body.reason ?? text, body.remedy ?? null, response.status, body.findings);
  } catch {
    return new Refused(text || `${response.status} ${response.statusText}`, null, response.status);
  }
}

let session: string | null = null;

/** All that is asked from now on is asked by this session. */
export function asSession(id: string | null): void {
  session = id;
}

async function ask(path: string, init: RequestInit = {}): Promise<Response> {
  const headers = new Headers(init.headers);
  if (session) headers.set('x-leadscrew-session', session);
  const response = await fetch(base + path, { credentials: 'same-origin', ...init, headers });
  if (!response.ok) throw await sentence(response);
  return response;
}

export async function get<T>(path: string): Promise<T> {
  return (await (await ask(path)).json()) as T;
}

export async function send<T>(path: string, body: unknown, signal?: AbortSignal): Promise<T> {
  const init = { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) };
  return (await (await ask(path, signal ? { ...init, signal } : init)).json()) as T;
}

/** A program's text, and which version of it this is. */
export async function getVersion(path: string): Promise<{ text: string; version: string | null }> {
  const response = await ask(path);
  return { text: await response.text(), version: response.headers.get('etag') };
}

/** Writes a program. `replaces`: the version that it replaces, `*` whichever is there, null none. */
export async function put(path: string, text: string, replaces: string | null): Promise<string | null> {
  const headers = { 'content-type': 'text/plain', ...(replaces ? { 'if-match': replaces } : {}) };
  return (await ask(path, { method: 'PUT', headers, body: text })).headers.get('etag');
}

/** An address of a file of the control, for a window of its own. */
export function fileAddress(path: string): string {
  return `${base}${path}${session ? `?session=${encodeURIComponent(session)}` : ''}`;
}

export function socketAddress(path = '/ws'): string {
  return `${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}${base}${path}${session ? `?session=${encodeURIComponent(session)}` : ''}`;
}

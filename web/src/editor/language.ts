// The editor's side of the language server: findings with what mends them, outline, time, hover, completion; over a socket of its own.
import { autocompletion, acceptCompletion, closeCompletion, completionKeymap, startCompletion } from '@codemirror/autocomplete';
import type { Diagnostic } from '@codemirror/lint';
import { hoverTooltips, LSPClient, LSPPlugin, serverCompletionSource, type Transport } from '@codemirror/lsp-client';
import { Compartment, Prec, type Extension, type Text } from '@codemirror/state';
import { EditorView, keymap } from '@codemirror/view';
import type * as lsp from 'vscode-languageserver-protocol';
import { socketAddress } from '../control/api';

/** A finding as the page lists it. */
export interface Shown {
  line: number;
  code: string;
  severity: 'error' | 'warning' | 'note';
  message: string;
  help: string | null;
  /** What mends it: the number that works is written into the text. */
  fix: { title: string; apply: () => void } | null;
  /** The dialect that the program is written for, if that is not how it is read. */
  readAs?: Reading | null;
}

/** A dialect: its name, and whose programs it reads. */
export interface Reading { dialect: string; people: string }

/** A tool change or a subprogram. */
export interface OutlineEntry { name: string; detail: string; line: number; isTool: boolean }

/** What is known of the text; null: it is being found out. */
export interface Known {
  findings: Shown[] | null;
  outline: OutlineEntry[];
  /** Seconds; undefined: the program is refused. */
  planned_s: number | null | undefined;
}

/** The socket is looked for again after so long. */
const again_ms = 1000;
/** What was typed is told after so long. */
const typed_ms = 250;
/** The time of a long program takes long to find out. */
const answered_ms = 300_000;
/** Elements of a hover: what the server writes needs no others. */
const elements = ['P', 'STRONG', 'EM', 'CODE', 'PRE', 'BR', 'TABLE', 'THEAD', 'TBODY', 'TR', 'TH', 'TD', 'UL', 'LI'];

/** A hover without anything but text and its form. */
function plain(html: string): string {
  const body = new DOMParser().parseFromString(html, 'text/html').body;
  for (const element of [...body.querySelectorAll('*')]) {
    if (!elements.includes(element.tagName)) element.replaceWith(element.textContent ?? '');
    else for (const { name } of [...element.attributes]) if (name !== 'align') element.removeAttribute(name);
  }
  return body.innerHTML;
}

const severities = ['error', 'warning', 'note', 'note'] as const;
const ofLint = { error: 'error', warning: 'warning', note: 'info' } as const;

export class Language {
  readonly #client: LSPClient;
  readonly #file = new Compartment();
  readonly #tell: (known: Known) => void;
  readonly #show: (diagnostics: Diagnostic[]) => void;
  #view: EditorView | null = null;
  #socket: WebSocket | null = null;
  #listener: ((message: string) => void) | null = null;
  #isOver = false;
  #typing: ReturnType<typeof setTimeout> | undefined;
  #known: Known = { findings: null, outline: [], planned_s: null };

  /** `tell` is told what is known, `show` what is to be underlined. */
  constructor(tell: (known: Known) => void, show: (diagnostics: Diagnostic[]) => void) {
    this.#tell = tell;
    this.#show = show;
    this.#client = new LSPClient({
      timeout: answered_ms,
      sanitizeHTML: plain,
      extensions: [hoverTooltips()],
      notificationHandlers: {
        'textDocument/publishDiagnostics': (_client, params: lsp.PublishDiagnosticsParams) => { void this.#found(params); return true; },
      },
    });
    this.#connect();
  }

  /** What the editor needs; Enter begins a line, so that a suggestion is taken with Tab. */
  get extension(): Extension {
    const keys = completionKeymap.filter(({ key }) => key !== 'Enter');
    return [
      this.#file.of([]),
      autocompletion({ override: [serverCompletionSource], defaultKeymap: false, icons: false }),
      Prec.highest(keymap.of([...keys, { key: 'Tab', run: acceptCompletion }])),
      EditorView.updateListener.of((update) => { if (update.docChanged) this.#typed(update.view); }),
    ];
  }

  /** A transaction's effect: from now on the text is the program of this name. */
  open(path: string) {
    this.#forget();
    return this.#file.reconfigure(this.#client.plugin(`program:/${path.split('/').map(encodeURIComponent).join('/')}`, 'gcode'));
  }

  /** Reads the program as one for another dialect; null: as the machine's file says. */
  readAs(dialect: string | null): void {
    const plugin = this.#view && LSPPlugin.get(this.#view);
    if (!plugin) return;
    this.#show([]);
    this.#forget();
    this.#client.notification('leadscrew/readAs', { textDocument: { uri: plugin.uri }, dialect });
  }

  complete(): void { if (this.#view) startCompletion(this.#view); }

  free(): void {
    this.#isOver = true;
    clearTimeout(this.#typing);
    if (this.#view) closeCompletion(this.#view);
    this.#socket?.close();
  }

  /** The view that the text is in. */
  use(view: EditorView): void { this.#view = view; }

  #connect(): void {
    const socket = new WebSocket(socketAddress('/lsp'));
    this.#socket = socket;
    const transport: Transport = {
      send: (message) => { if (socket.readyState === WebSocket.OPEN) socket.send(message); },
      subscribe: (listener) => (this.#listener = listener),
      unsubscribe: () => (this.#listener = null),
    };
    socket.onopen = () => this.#client.connect(transport);
    socket.onmessage = ({ data }: MessageEvent<string>) => this.#listener?.(data);
    socket.onclose = () => {
      this.#client.disconnect();
      if (this.#isOver) return;
      this.#forget();
      setTimeout(() => { if (!this.#isOver) this.#connect(); }, again_ms);
    };
  }

  #forget(): void { this.#now({ findings: null, outline: [], planned_s: null }); }

  #now(known: Partial<Known>): void {
    this.#known = { ...this.#known, ...known };
    this.#tell(this.#known);
  }

  #typed(view: EditorView): void {
    this.#view = view;
    this.#now({ planned_s: null });
    clearTimeout(this.#typing);
    this.#typing = setTimeout(() => this.#client.sync(), typed_ms);
  }

  /** The file of the text, if these findings are of it as it is. */
  #plugin(params: lsp.PublishDiagnosticsParams): LSPPlugin | null {
    const plugin = this.#view && LSPPlugin.get(this.#view);
    const file = this.#client.workspace.getFile(params.uri);
    return plugin && file && plugin.uri === params.uri && (params.version ?? file.version) === file.version ? plugin : null;
  }

  async #found(params: lsp.PublishDiagnosticsParams): Promise<void> {
    const plugin = this.#plugin(params);
    if (!plugin) return;
    this.#list(plugin, params.diagnostics, []);
    const textDocument = { uri: params.uri };
    const last = plugin.toPosition(plugin.syncedDoc.length, plugin.syncedDoc);
    const whole = { start: { line: 0, character: 0 }, end: last };
    const ask = async <T>(method: string, more: object = {}) =>
      this.#client.request<object, T | null>(method, { textDocument, ...more }).catch(() => null);
    const [symbols, fixes] = await Promise.all([
      ask<lsp.DocumentSymbol[]>('textDocument/documentSymbol'),
      params.diagnostics.length > 0 ? ask<lsp.CodeAction[]>('textDocument/codeAction', { range: whole, context: { diagnostics: [] } }) : null,
    ]);
    if (this.#plugin(params) !== plugin) return;
    const isTool = ({ kind }: lsp.DocumentSymbol) => kind === 19; // an object
    this.#now({ outline: (symbols ?? []).map((symbol) => ({ name: symbol.name, detail: symbol.detail ?? '', line: symbol.selectionRange.start.line + 1, isTool: isTool(symbol) })) });
    if (fixes && fixes.length > 0) this.#list(plugin, params.diagnostics, fixes);
    const time = await ask<{ planned_s: number | null }>('leadscrew/plannedTime');
    if (time && this.#plugin(params) === plugin) this.#now({ planned_s: time.planned_s ?? undefined });
  }

  #list(plugin: LSPPlugin, all: lsp.Diagnostic[], fixes: lsp.CodeAction[]): void {
    const doc = plugin.syncedDoc;
    const at = (position: lsp.Position) => plugin.unsyncedChanges.mapPos(plugin.fromPosition(position, doc));
    const findings: Shown[] = [];
    const diagnostics = all.map((found): Diagnostic => {
      const of = ({ diagnostics }: lsp.CodeAction) => diagnostics?.some((one) => one.code === found.code && one.range.start.line === found.range.start.line && one.message === found.message);
      const action = fixes.find(of);
      const apply = () => { if (action) this.#apply(plugin, action, doc); };
      const text = typeof found.message === 'string' ? found.message : found.message.value;
      const [message = '', ...help] = text.split('\n');
      const severity = severities[(found.severity ?? 1) - 1] ?? 'error';
      const code = String(found.code ?? '');
      findings.push({ line: found.range.start.line + 1, code, severity, message, help: help.join(' ') || null, fix: action ? { title: action.title, apply } : null, readAs: (found.data as Reading | undefined) ?? null });
      const actions = action ? [{ name: action.title, apply }] : [];
      return { from: at(found.range.start), to: at(found.range.end), severity: ofLint[severity], source: code, message: text, actions };
    });
    this.#show(diagnostics);
    this.#now({ findings });
  }

  /** Writes the number that works, unless the text has changed meanwhile. */
  #apply(plugin: LSPPlugin, action: lsp.CodeAction, doc: Text): void {
    if (plugin.view.state.doc !== doc) return;
    const edits = action.edit?.changes?.[plugin.uri] ?? [];
    plugin.view.dispatch({
      changes: edits.map(({ range, newText }) => ({ from: plugin.fromPosition(range.start, doc), to: plugin.fromPosition(range.end, doc), insert: newText })),
      userEvent: 'input.complete',
    });
    this.#client.sync();
  }
}

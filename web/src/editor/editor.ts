// The editor of programs: CodeMirror in a shadow root, where its styles need no exception in the page's policy.
import { defaultKeymap, history, historyKeymap, indentWithTab } from '@codemirror/commands';
import { HighlightStyle, StreamLanguage, syntaxHighlighting } from '@codemirror/language';
import { lintGutter, setDiagnostics, type Diagnostic } from '@codemirror/lint';
import { highlightSelectionMatches, search, searchKeymap } from '@codemirror/search';
import { EditorState, StateEffect, StateField } from '@codemirror/state';
import { Decoration, drawSelection, EditorView, highlightActiveLine, highlightActiveLineGutter, keymap, lineNumbers, type DecorationSet } from '@codemirror/view';
import { tags } from '@lezer/highlight';
import { programTexts } from '../texts/en';
import { Language, type Known } from './language';

const gcode = StreamLanguage.define<object>({
  token(stream) {
    if (stream.match(/\([^)]*\)?/) || stream.match(/;.*/)) return 'comment';
    if (stream.match(/[oO](?:<[^>]*>|\d+)/) || stream.match(/\b(?:sub|endsub|call|if|elseif|else|endif|while|endwhile|do|repeat|endrepeat|return|break|continue)\b/i)) return 'keyword';
    if (stream.match(/#(?:<[^>]*>|\d+)/)) return 'variableName';
    if (stream.match(/[gG]\s*\d+(?:\.\d+)?/)) return 'typeName';
    if (stream.match(/[mM]\s*\d+/)) return 'operatorKeyword';
    if (stream.match(/[nN]\s*\d+/)) return 'meta';
    if (stream.match(/[a-zA-Z]\s*[-+]?\d*\.?\d+/)) return 'number';
    stream.next();
    return null;
  },
});

const colors = HighlightStyle.define([
  { tag: tags.comment, color: 'var(--quiet)' },
  { tag: tags.keyword, color: 'var(--path-thread)' },
  { tag: tags.variableName, color: 'var(--amber)' },
  { tag: tags.typeName, color: 'var(--blue)', fontWeight: '500' },
  { tag: tags.operatorKeyword, color: 'var(--green)', fontWeight: '500' },
  { tag: tags.meta, color: 'var(--old)' },
]);

const look = EditorView.theme({
  '&': { height: '100%', color: 'var(--text)', backgroundColor: 'var(--sunk)', fontSize: '0.9375rem' },
  '&.cm-focused': { outline: '2px solid var(--focus)' },
  '.cm-scroller': { fontFamily: 'Roboto, sans-serif', fontVariantNumeric: 'tabular-nums', lineHeight: '1.6', overflow: 'auto' },
  '.cm-gutters': { backgroundColor: 'var(--sunk)', color: 'var(--old)', border: 'none' },
  '.cm-activeLine, .cm-activeLineGutter': { backgroundColor: 'color-mix(in srgb, var(--blue-ground) 55%, transparent)' },
  '.cm-cursor': { borderLeftColor: 'var(--text)' },
  '&.cm-focused .cm-selectionBackground, .cm-selectionBackground': { backgroundColor: 'var(--blue-ground) !important' },
  '.cm-executed': { backgroundColor: 'var(--green-ground)', boxShadow: 'inset 4px 0 var(--green-fill)' },
  '.cm-tooltip .cm-lsp-documentation, .cm-completionInfo': { padding: '0.25rem 0.5rem', maxWidth: '30rem' },
  '.cm-lsp-documentation table': { borderCollapse: 'collapse' },
  '.cm-lsp-documentation th, .cm-lsp-documentation td': { padding: '0 0.5rem', textAlign: 'right', fontVariantNumeric: 'tabular-nums' },
  '.cm-tooltip.cm-tooltip-autocomplete > ul': { fontFamily: 'Roboto, sans-serif' },
  '.cm-tooltip-autocomplete ul li[aria-selected]': { background: 'var(--blue)', color: 'var(--on-blue)' },
  '.cm-completionDetail': { fontStyle: 'normal' },
  '.cm-diagnostic': { borderLeftWidth: '4px', whiteSpace: 'pre-wrap' },
  '.cm-diagnosticAction': { minHeight: '2.75rem', padding: '0 0.75rem', backgroundColor: 'var(--blue)', color: 'var(--on-blue)', borderRadius: '4px', font: 'inherit', fontWeight: '500', margin: '0.25rem 0 0' },
  '.cm-tooltip, .cm-panels': { backgroundColor: 'var(--panel)', color: 'var(--text)', borderColor: 'var(--line)' },
});

const executed = StateEffect.define<number>();
const executedLine = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(lines, transaction) {
    let marked = lines.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(executed)) continue;
      const { doc } = transaction.state;
      const isThere = effect.value > 0 && effect.value <= doc.lines;
      marked = isThere ? Decoration.set([Decoration.line({ class: 'cm-executed' }).range(doc.line(effect.value).from)]) : Decoration.none;
    }
    return marked;
  },
  provide: (field) => EditorView.decorations.from(field),
});

export class ProgramEditor {
  readonly #view: EditorView;
  readonly #language: Language;
  #isSet = false;

  constructor(box: HTMLElement, onchange: () => void, onknown: (known: Known) => void) {
    const root = box.attachShadow({ mode: 'open' });
    this.#language = new Language(onknown, (diagnostics) => this.#show(diagnostics));
    // The editor's own styles go where no style element is made: into sheets of the shadow root.
    const state = EditorState.create({
      extensions: [
        lineNumbers(), history(), drawSelection(), highlightActiveLine(), highlightActiveLineGutter(), highlightSelectionMatches(),
        search({ top: true }), lintGutter(), this.#language.extension, gcode, syntaxHighlighting(colors), look, executedLine,
        keymap.of([...defaultKeymap, ...historyKeymap, ...searchKeymap, indentWithTab]),
        EditorView.contentAttributes.of({ 'aria-label': programTexts.editor }),
        EditorView.updateListener.of((update) => { if (update.docChanged && !this.#isSet) onchange(); }),
      ],
    });
    this.#view = new EditorView({ state, parent: root, root });
    this.#language.use(this.#view);
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(':host{min-height:0;min-width:0}');
    root.adoptedStyleSheets = [...root.adoptedStyleSheets, sheet];
  }

  get text(): string { return this.#view.state.doc.toString(); }

  /** Another program is edited: its path in the folder, and its text. */
  set(path: string, text: string): void {
    this.#isSet = true;
    this.#show([]); // what was found was of the text before
    this.#view.dispatch({ changes: { from: 0, to: this.#view.state.doc.length, insert: text }, effects: this.#language.open(path) });
    this.#isSet = false;
  }

  /** The text has another name from now on. */
  name(path: string): void {
    this.#view.dispatch({ effects: this.#language.open(path) });
  }

  /** Reads the text as a program for another dialect; null: as the machine does. */
  readAs(dialect: string | null): void { this.#language.readAs(dialect); }

  /** Marks the line that is executed; 0 is none. */
  mark(line: number): void {
    this.#view.dispatch({ effects: executed.of(line) });
  }

  #show(diagnostics: Diagnostic[]): void {
    this.#view.dispatch(setDiagnostics(this.#view.state, diagnostics));
  }

  go(line: number): void {
    const { doc } = this.#view.state;
    const at = doc.line(Math.min(doc.lines, Math.max(1, line))).from;
    this.#view.dispatch({ selection: { anchor: at }, effects: EditorView.scrollIntoView(at, { y: 'center' }) });
    this.#view.focus();
  }

  free(): void {
    this.#language.free();
    this.#view.destroy();
  }
}

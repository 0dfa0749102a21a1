// The editor of programs: CodeMirror in a shadow root, where its styles need no exception in the page's policy.
import { defaultKeymap, history, historyKeymap, indentWithTab } from '@codemirror/commands';
import { HighlightStyle, StreamLanguage, syntaxHighlighting } from '@codemirror/language';
import { lintGutter, setDiagnostics, type Diagnostic } from '@codemirror/lint';
import { highlightSelectionMatches, search, searchKeymap } from '@codemirror/search';
import { EditorState, StateEffect, StateField } from '@codemirror/state';
import { Decoration, drawSelection, EditorView, highlightActiveLine, highlightActiveLineGutter, keymap, lineNumbers, type DecorationSet } from '@codemirror/view';
import { tags } from '@lezer/highlight';
import type { Finding } from '../control/model';
import { programTexts } from '../texts/en';

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
  #isSet = false;

  constructor(box: HTMLElement, onchange: () => void) {
    const root = box.attachShadow({ mode: 'open' });
    // The editor's own styles go where no style element is made: into sheets of the shadow root.
    const state = EditorState.create({
      extensions: [
        lineNumbers(), history(), drawSelection(), highlightActiveLine(), highlightActiveLineGutter(), highlightSelectionMatches(),
        search({ top: true }), lintGutter(), gcode, syntaxHighlighting(colors), look, executedLine,
        keymap.of([...defaultKeymap, ...historyKeymap, ...searchKeymap, indentWithTab]),
        EditorView.contentAttributes.of({ 'aria-label': programTexts.editor }),
        EditorView.updateListener.of((update) => { if (update.docChanged && !this.#isSet) onchange(); }),
      ],
    });
    this.#view = new EditorView({ state, parent: root, root });
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(':host{min-height:0;min-width:0}');
    root.adoptedStyleSheets = [...root.adoptedStyleSheets, sheet];
  }

  get text(): string { return this.#view.state.doc.toString(); }

  set(text: string): void {
    this.#isSet = true;
    this.#view.dispatch({ changes: { from: 0, to: this.#view.state.doc.length, insert: text } });
    this.#isSet = false;
  }

  /** Marks the line that is executed; 0 is none. */
  mark(line: number): void {
    this.#view.dispatch({ effects: executed.of(line) });
  }

  show(findings: Finding[]): void {
    const { doc } = this.#view.state;
    const diagnostics = findings.filter(({ line }) => line > 0 && line <= doc.lines).map(({ line, column, severity, message, help }): Diagnostic => {
      const { from, to } = doc.line(line);
      return { from: Math.min(to, from + Math.max(0, column - 1)), to, severity: severity === 'error' ? 'error' : 'warning', message: [message, help].filter(Boolean).join('\n') };
    });
    this.#view.dispatch(setDiagnostics(this.#view.state, diagnostics));
  }

  go(line: number): void {
    const { doc } = this.#view.state;
    const at = doc.line(Math.min(doc.lines, Math.max(1, line))).from;
    this.#view.dispatch({ selection: { anchor: at }, effects: EditorView.scrollIntoView(at, { y: 'center' }) });
    this.#view.focus();
  }

  free(): void { this.#view.destroy(); }
}

//! What is legal but hurts, read from the text alone, in all of its lines.
//!
//! ```text
//!   text ──► Parser ──► Reader ── I09xx ──►  a parameter read before it is set, a subprogram that nobody
//!              └─────── P0xxx ─────────►     calls, a length offset of another tool, …
//! ```
//!
//! These remarks follow the text from top to bottom and understand plain numbers only: where a
//! program computes what it does, they keep silent. What is an error is found by executing, not
//! here.
use crate::setup::Setup;
use diag::{Diagnostic, Span};
use gcode::{Block, Expr, Grammar, Keyword, Label, MAX_DIAGNOSTICS, Parameter, Parser, Value};
use std::collections::{HashMap, HashSet};

/// Words of which G81 has one where it drills.
const HOLE_WORDS: &[u8] = b"XYZABCUVW@^";
/// Parameters up to this one belong to a subprogram's call.
const ARGUMENTS: u32 = 30;
/// Parameters up to this one are the program's own; those above it mean something.
const FREE: u32 = 5000;
/// Longest dwell that is surely meant in seconds.
const LONGEST_DWELL_S: f64 = 60.0;
/// Moves of a program in which Z goes along with X or Y, from which on it is a 3D program.
const MANY_SLOPES: u32 = 20;

/// What is legal but hurts, and what the parser finds wrong in any line, by place.
pub fn lint(source: &[u8], setup: &Setup) -> Vec<Diagnostic> {
    let mut lint = Lint::new(setup);
    while lint.advance(source, usize::MAX) {}
    lint.finish(setup)
}

/// [`lint`], some blocks at a time.
pub struct Lint {
    /// None for Fanuc's dialects: the remarks know the words of RS-274 only.
    reader: Option<Reader>,
    grammar: Grammar,
    /// Byte and line where it goes on.
    at: (u32, u32),
    found: Vec<Diagnostic>,
}

impl Lint {
    /// At the beginning of a program.
    pub fn new(setup: &Setup) -> Self {
        let grammar = setup.dialect.grammar();
        let reader = (grammar != Grammar::Fanuc).then(|| Reader::new(setup));
        Self { reader, grammar, at: (0, 1), found: Vec::new() }
    }

    /// Read on in the program's text; false if it is over.
    pub fn advance(&mut self, source: &[u8], blocks: usize) -> bool {
        let (mut parser, mut block) = (Parser::with_grammar(source, 0, self.grammar), Block::new());
        if self.at != (0, 1) {
            parser.seek(self.at.0, self.at.1);
        }
        let mut more = true;
        for _ in 0..blocks {
            more = parser.next(&mut block);
            if !more {
                break;
            }
            if let Some(reader) = self.reader.as_mut().filter(|_| !block.faulty) {
                reader.block(&block);
            }
        }
        self.at = parser.position();
        if self.found.len() < MAX_DIAGNOSTICS {
            self.found.extend(parser.take_diagnostics());
        }
        more
    }

    /// What was found.
    pub fn finish(self, setup: &Setup) -> Vec<Diagnostic> {
        let mut found = self.found;
        found.extend(self.reader.into_iter().flat_map(|reader| reader.finish(setup)));
        found.sort_by_key(|finding| finding.span.start);
        found
    }
}

/// What is remembered from line to line.
#[allow(clippy::struct_excessive_bools)] // independent facts about the text so far
#[derive(Default)]
pub(crate) struct Reader {
    /// The G word that changes tools, if there is one.
    changes_tools: Option<f64>,
    found: Vec<Diagnostic>,
    /// Subprograms by label, and where they begin.
    subs: Vec<(String, Span)>,
    called: HashSet<String>,
    computed_call: bool,
    inside_sub: bool,
    /// Parameters set so far, and where those not yet set were read first.
    set: HashSet<u32>,
    read: HashMap<u32, (Span, bool)>,
    computed_setting: bool,
    feeds: bool,
    slopes: u32,
    first_slope: Span,
    path_control: bool,
    /// G94 or G95 that has just cleared the feed, while no F followed.
    cleared: Option<Span>,
    selected: Option<(u32, Span)>,
    /// T needs no M6.
    tools_by_hand: bool,
    spindle: Option<u32>,
    /// M6 or M61 has put a tool into the spindle, if only in a subprogram.
    changed: bool,
    turns: bool,
    /// The spindle was empty in a cut after the last T: the planner says it at the cut.
    cut_empty: bool,
    ended: bool,
    said_after_end: bool,
}

impl Reader {
    pub(crate) fn new(setup: &Setup) -> Self {
        let known = setup.parameters.iter().map(|(number, _)| number as u32).collect();
        let changes_tools = setup.dialect.rules().writes_own(crate::codes::NON_STOP_CHANGE);
        let tools_by_hand = setup.dialect.rules().tools_by_hand;
        Self { changes_tools, tools_by_hand, set: known, ..Self::default() }
    }

    pub(crate) fn block(&mut self, block: &Block) {
        if let Some(o) = block.o {
            self.o_word(block, o);
        } else if block.percent {
            self.ended = false;
        } else if self.ended && !block.is_blank() && !self.said_after_end {
            self.said_after_end = true;
            let text = "this is never executed: the program ended before it";
            self.found.push(
                Diagnostic::warning("I0906", block.span, text)
                    .with_help("M2 and M30 end a program wherever they stand"),
            );
        }
        self.parameters(block);
        if !block.words.is_empty() {
            self.words(block);
        }
    }

    fn o_word(&mut self, block: &Block, o: gcode::OWord) {
        let label = match o.label {
            Label::Number(number) => number.to_string(),
            Label::Name(name) => format!("<{}>", block.text(name)),
            Label::Computed(_) => {
                self.computed_call = true;
                return;
            }
        };
        match o.keyword {
            Keyword::Sub => {
                self.inside_sub = true;
                self.ended = false;
                self.subs.push((label, o.span));
            }
            Keyword::EndSub => self.inside_sub = false,
            Keyword::Program => self.ended = false,
            Keyword::Call => _ = self.called.insert(label),
            _ => {}
        }
    }

    fn parameters(&mut self, block: &Block) {
        for word in &block.words {
            self.value(block, word.value);
        }
        for argument in &block.arguments {
            self.value(block, *argument);
        }
        for setting in &block.assignments {
            self.value(block, setting.value);
        }
        for setting in &block.assignments {
            match setting.target {
                Parameter::Numbered(Value::Number(number)) => _ = self.set.insert(number as u32),
                Parameter::Numbered(Value::Expression(_)) => self.computed_setting = true,
                Parameter::Named(_) => {}
            }
        }
    }

    fn value(&mut self, block: &Block, value: Value) {
        let Value::Expression(id) = value else { return };
        match block.expr(id) {
            Expr::Parameter(Parameter::Numbered(Value::Number(number))) => {
                self.reads(number as u32, block.expr_span(id));
            }
            Expr::Parameter(Parameter::Numbered(inner)) => self.value(block, inner),
            Expr::Negate(inner) | Expr::Function { argument: inner, .. } => {
                self.value(block, inner);
            }
            Expr::Binary { left, right, .. }
            | Expr::Atan { y: left, x: right }
            | Expr::Pow { base: left, exponent: right } => {
                self.value(block, left);
                self.value(block, right);
            }
            Expr::Parameter(Parameter::Named(_)) | Expr::Exists(_) => {}
        }
    }

    fn reads(&mut self, number: u32, span: Span) {
        let own = self.inside_sub && number <= ARGUMENTS;
        if own || !(1..=FREE).contains(&number) || self.set.contains(&number) {
            return;
        }
        self.read.entry(number).or_insert((span, self.inside_sub));
    }

    fn words(&mut self, block: &Block) {
        let number = |letter: u8| match block.word(letter).map(|word| word.value) {
            Some(Value::Number(number)) => Some(number),
            _ => None,
        };
        let has = |letter: u8| block.word(letter).is_some();
        let mut dwells = false;
        self.feed_cleared(block);
        if let (Some(70.0..=72.9), Some(profile)) = (number(b'G'), number(b'Q')) {
            self.called.insert(format!("{profile}"));
        }
        for word in &block.words {
            let Value::Number(value) = word.value else { continue };
            match (word.letter, (value * 10.0).round() as i64) {
                (b'G', 0 | 330 | 331 | 730..=899) => self.feeds = false,
                (b'G', 10 | 20 | 30) => self.feeds = true,
                (b'G', 610 | 611) => self.path_control = true,
                (b'G', 640) => self.path_control |= has(b'P'),
                (b'G', 40) => dwells = true,
                (b'M', 30 | 40) => self.turns = true,
                (b'M', 50) => self.turns = false,
                (b'M', 20 | 300) => self.ended = true,
                _ => {}
            }
        }
        if self.feeds && has(b'Z') && (has(b'X') || has(b'Y')) {
            if self.slopes == 0 {
                self.first_slope = block.span;
            }
            self.slopes += 1;
        }
        if dwells && let Some(seconds) = number(b'P').filter(|s| *s > LONGEST_DWELL_S) {
            self.long_dwell(block, seconds);
        }
        self.tools(block, number(b'T'), number(b'H'));
        let moves = block.words.iter().any(|word| b"XYZ".contains(&word.letter));
        self.cut_empty |= moves && self.feeds && self.turns && !self.changed;
    }

    /// G94 and G95 clear the feed, also where they were in force: said where no F comes before the
    /// program ends.
    fn feed_cleared(&mut self, block: &Block) {
        let is = |code: f64| {
            block.words.iter().find(|w| w.letter == b'G' && w.value == Value::Number(code))
        };
        if block.word(b'F').is_some() {
            self.cleared = None;
        } else if let Some(word) = is(95.0) {
            self.cleared = Some(word.span);
        } else if is(93.0).or(is(94.0)).is_some() {
            self.cleared = None;
        }
    }

    fn long_dwell(&mut self, block: &Block, seconds: f64) {
        let span = block.word(b'P').map_or(block.span, |word| word.span);
        let text = format!("this waits {seconds} s: P is in seconds");
        let help = format!("for {seconds} milliseconds write P{}", seconds / 1000.0);
        self.found.push(Diagnostic::warning("I0904", span, text).with_help(help));
    }

    /// T, M6, G43.
    fn tools(&mut self, block: &Block, t: Option<f64>, h: Option<f64>) {
        let is = |letter: u8, code: f64| {
            block.words.iter().any(|w| w.letter == letter && w.value == Value::Number(code))
        };
        // hobbing: T is the teeth of the gear
        let teeth = is(b'G', 81.0) && !block.words.iter().any(|w| HOLE_WORDS.contains(&w.letter));
        if teeth {
            return;
        }
        if let Some(number) = t.filter(|t| *t >= 0.0) {
            let span = block.word(b'T').map_or(block.span, |word| word.span);
            self.selected = Some((number as u32, span));
            self.cut_empty = false;
        } else if block.word(b'T').is_some() {
            (self.selected, self.spindle) = (None, None);
        }
        if is(b'M', 6.0) || self.changes_tools.is_some_and(|code| is(b'G', code)) {
            self.spindle = self.selected.take().map(|(number, _)| number);
            self.changed = true;
        }
        if is(b'M', 61.0) {
            self.spindle = None;
            self.changed = true;
        }
        if self.inside_sub {
            self.spindle = None;
        }
        let (Some(mounted), Some(h)) = (self.spindle, h) else { return };
        if is(b'G', 43.0) && h != f64::from(mounted) && h != 0.0 {
            let span = block.word(b'H').map_or(block.span, |word| word.span);
            let text = format!("H{h} is the length of another tool: T{mounted} is in the spindle");
            let help = format!("write G43 H{mounted}, or G43 alone for the tool in the spindle");
            self.found.push(Diagnostic::warning("I0905", span, text).with_help(help));
        }
    }

    /// What was found since the last time.
    pub(crate) fn take(&mut self) -> Vec<Diagnostic> {
        core::mem::take(&mut self.found)
    }

    pub(crate) fn finish(mut self, setup: &Setup) -> Vec<Diagnostic> {
        self.uncalled_subs(setup);
        self.unset_parameters(setup);
        if self.slopes >= MANY_SLOPES && !self.path_control {
            let text = "a 3D program without G64 P: nothing bounds how far its corners are rounded";
            let help =
                "write G64 P0.01 (in program units) at its beginning, or G61 for the exact path";
            self.found.push(Diagnostic::warning("I0903", self.first_slope, text).with_help(help));
        }
        if let Some(span) = self.cleared {
            let text = "G95 clears the feed, and no F follows it";
            let help = "write F, the feed per revolution, in this block: G95 F0.1";
            self.found.push(Diagnostic::warning("I0908", span, text).with_help(help));
        }
        let is_known = self.cut_empty || self.tools_by_hand;
        let selected = self.selected.filter(|(number, _)| *number > 0 && !is_known);
        if let Some((number, span)) = selected {
            let text = format!("T{number} is selected, and no M6 after it brings it");
            let finding = Diagnostic::note("I0907", span, text);
            self.found.push(finding.with_help("write M6 in this block or after it"));
        }
        self.found
    }

    fn uncalled_subs(&mut self, setup: &Setup) {
        let name = |label: &str| label.trim_matches(['<', '>']).to_owned();
        let calls_by_files = |label: &str| {
            let label = name(label);
            setup
                .subprograms
                .iter()
                .any(|file| crate::called_files(&file.source, Grammar::Rs274).contains(&label))
        };
        if self.computed_call {
            return;
        }
        for (label, span) in &self.subs {
            if self.called.contains(label) || calls_by_files(label) {
                continue;
            }
            // A file with nothing but a subprogram is called from elsewhere.
            if self.subs.len() == 1 && !self.said_after_end && self.called.is_empty() && !self.ended
            {
                continue;
            }
            let text = format!("o{label} is never called");
            let near = self.called.iter().find(|called| {
                !self.subs.iter().any(|(sub, _)| sub == *called)
                    && crate::words::names::distance(called, label) <= 2
            });
            let finding = Diagnostic::warning("I0901", *span, text);
            self.found.push(match near {
                Some(near) => finding.with_help(format!("o{near} is called: was this one meant?")),
                None => finding.with_help(format!("call it with `o{label} call`, or remove it")),
            });
        }
    }

    fn unset_parameters(&mut self, setup: &Setup) {
        if self.computed_setting {
            return;
        }
        for (number, (span, in_sub)) in &self.read {
            let set_later = self.set.contains(number);
            let elsewhere = *number > ARGUMENTS && !setup.subprograms.is_empty();
            if elsewhere || *in_sub && set_later {
                continue;
            }
            let text = format!("#{number} is read before it is set: it is 0 here");
            let help = if set_later {
                format!("set it above this line, for instance #{number} = 1")
            } else {
                format!("no line sets it: write #{number} = … above, or the number that is meant")
            };
            self.found.push(Diagnostic::warning("I0902", *span, text).with_help(help));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn codes(text: &str) -> Vec<&'static str> {
        codes_in(crate::Dialect::default(), text)
    }

    fn codes_in(dialect: crate::Dialect, text: &str) -> Vec<&'static str> {
        let setup = Setup { dialect, ..Setup::default() };
        lint(text.as_bytes(), &setup).iter().map(|finding| finding.code).collect()
    }

    #[test]
    fn a_parameter_read_before_it_is_set_is_named() {
        assert_eq!(codes("G0 X#100\n#100=5\nM2\n"), ["I0902"]);
        assert_eq!(codes("#100=5\nG0 X#100\nM2\n"), [""; 0]);
        assert_eq!(codes("o1 sub\nG0 X#1 Y#7\no1 endsub\no1 call [1]\nM2\n"), [""; 0]);
        assert_eq!(codes("o1 sub\nG0 X#100\no1 endsub\n#100=3\no1 call\nM2\n"), [""; 0]);
        assert_eq!(codes("#1=3 #[#1+40]=5\nG0 X#43\nM2\n"), [""; 0]);
        assert_eq!(codes("#100=#100\nM2\n"), ["I0902"]);
    }

    #[test]
    fn a_subprogram_that_nobody_calls_is_named() {
        assert_eq!(codes("o<a> sub\no<a> endsub\nG0 X1\nM2\n"), ["I0901"]);
        assert_eq!(codes("o<a> sub\no<a> endsub\no<a> call\nM2\n"), [""; 0]);
        assert_eq!(codes("o<a> sub\no<a> endsub\n"), [""; 0], "a subprogram file");
    }

    #[test]
    fn a_3d_program_wants_its_corners_bounded() {
        let slopes = "G1 X1 Y1 Z1 F9\n".repeat(MANY_SLOPES as usize);
        assert_eq!(codes(&format!("G64\n{slopes}M2\n")), ["I0903"]);
        assert_eq!(codes(&format!("G64 P0.01\n{slopes}M2\n")), [""; 0]);
        assert_eq!(codes(&format!("{}M2\n", slopes.replace("G1", "G0"))), [""; 0]);
    }

    #[test]
    fn the_length_of_another_tool_is_noticed() {
        assert_eq!(codes("T3 M6\nG43 H2\nM2\n"), ["I0905"]);
        assert_eq!(codes("T3 M6\nG43 H3\nT2\nM6 G43\nM2\n"), [""; 0]);
    }

    #[test]
    fn an_arc_that_does_not_close_gets_the_centre_that_would_fit() {
        // From (0, 0) to (10, 0) about (4, 0): the nearest centre as far from both ends is (5, 0).
        let text = b"G21 G90\nG0 X0 Y0\nG2 X10 I4 F100\nM2\n";
        let found = crate::check(text, &Setup::default());
        assert_eq!(found[0].code, "I0414");
        assert!(found[0].help.as_ref().is_some_and(|help| help.starts_with("I5.0000 J0.0000 ")));
    }

    #[test]
    fn other_habits_that_hurt() {
        assert_eq!(codes("G4 P500\nM2\n"), ["I0904"]);
        assert_eq!(codes("M2\nG0 X1\nG0 X2\n"), ["I0906"]);
        assert_eq!(codes("T3\nM2\n"), ["I0907"]);
        assert!(codes_in(crate::Dialect::Grbl, "T3\nM2\n").is_empty(), "clamped by hand");
        // the cut itself is a finding of the planner
        assert!(codes("T3\nM3 S900\nG1 X9 F90\nM2\n").is_empty());
        assert_eq!(codes("T3\nG1 X9 F90\nM2\n"), ["I0907"]);
        assert_eq!(codes("T3 M6\nM3 S900\nG1 X9 F90\nT4\nG1 X0\nM2\n"), ["I0907"]);
        // of a gear T is the teeth; of a hole it is a tool
        assert!(codes("T1 M6\nM3 S300\nG81 T20 L1 Q2\nG80\nM2\n").is_empty());
    }
}

//! A text's blocks, and where its O-words or a tape's numbered blocks are, kept while the text is edited.
//!
//! ```text
//!   o1 if [#1 gt 2]   ── edited to ──►   o1 if [#1 gt 25]     the same O-words: their places move
//!   o1 endif          ── edited to ──►   o1 endwhile          others: the text is read again
//! ```
//!
//! A first jump costs a reading of the whole text, so whoever executes a text in pieces hands them on from piece to
//! piece. What steers (O-words but calls and returns; of a tape O, N, DO and END) is compared line by line: as long
//! as an edit leaves it as it was, whatever else it changes, jumps lead where they led before. So they do where O-words
//! that belong together come or go; and on a tape all those but the jumps to the numbers that have come or gone.
use crate::{
    Interpreter, Shift,
    fanuc::Tape,
    outline::{At, Outline},
    pages::Pages,
};
use diag::Span;
use gcode::Grammar;

/// Of each file, if it was asked for.
#[derive(Clone, Debug, Default)]
pub struct Contents {
    outlines: Vec<Option<Outline>>,
    tape: Option<Tape>,
    pages: Box<Pages>,
}

/// What an edit has done to what steers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Steering {
    /// It leads where it led.
    Same,
    /// Jumps of a tape to these numbers may lead elsewhere.
    Jumps(Vec<u32>),
    /// It is not known what steers.
    Unknown,
}

/// The lines that an edit touched, in the text as it is now.
pub(crate) struct Edited<'a> {
    /// The text up to their end.
    pub(crate) source: &'a [u8],
    /// The first one's begin.
    pub(crate) first: At,
    /// Their end in the text as it was.
    pub(crate) old_end: u32,
    pub(crate) shift: &'a Shift,
}

impl Contents {
    /// Take in an edit of the program's text, whose first line touched begins at `first` (byte and line).
    pub fn edited(
        &mut self,
        source: &[u8],
        shift: &Shift,
        first: At,
        grammar: Grammar,
    ) -> Steering {
        let edited = Edited::of(source, shift, first);
        self.pages.edited(&edited);
        if grammar == Grammar::Fanuc {
            let changed = self.tape.take().and_then(|tape| tape.edited(&edited));
            let Some((tape, changed)) = changed else { return Steering::Unknown };
            self.tape = Some(tape);
            return if changed.is_empty() { Steering::Same } else { Steering::Jumps(changed) };
        }
        let Some(own) = self.outlines.first_mut() else { return Steering::Unknown };
        *own = own.take().and_then(|outline| outline.edited(&edited));
        if own.is_some() { Steering::Same } else { Steering::Unknown }
    }
}

impl<'a> Edited<'a> {
    pub(crate) fn of(source: &'a [u8], shift: &'a Shift, first: At) -> Self {
        let from = (shift.new_end as usize).min(source.len());
        if shift.whole_lines {
            return Self { source: &source[..from], first, old_end: shift.old_end, shift };
        }
        let end = memchr::memchr(b'\n', &source[from..]).map_or(source.len(), |at| from + at + 1);
        let old_end = (end as u32 - from as u32).saturating_add(shift.old_end);
        Self { source: &source[..end], first, old_end, shift }
    }

    /// Whether a block that began here lay in these lines.
    pub(crate) const fn had(&self, at: At) -> bool {
        self.first.0 <= at.0 && at.0 < self.old_end
    }

    /// Where a block outside of these lines begins now.
    pub(crate) const fn moved(&self, at: At) -> At {
        if at.0 < self.old_end || at.0 < self.first.0 {
            return at;
        }
        let Shift { old_end, new_end, .. } = *self.shift;
        (at.0 - old_end + new_end, self.shift.line(at.1))
    }

    /// Where such a block's stretch is now.
    pub(crate) const fn moved_span(&self, span: Span) -> Span {
        let (start, line) = self.moved((span.start, span.line));
        Span { start, line, end: start + (span.end - span.start), ..span }
    }
}

impl Interpreter<'_> {
    /// Go by what was read before of this very text.
    #[must_use]
    pub fn with_contents(mut self, contents: Contents) -> Self {
        self.pages = Some(contents.pages);
        for (own, known) in self.outlines.iter_mut().zip(contents.outlines) {
            *own = known;
        }
        if let Some(fanuc) = &mut self.fanuc {
            fanuc.set_tape(contents.tape);
        }
        self
    }

    /// What was read; no O-words of a text where they do not fit together.
    pub fn take_contents(&mut self) -> Contents {
        let pages = self.pages.take().unwrap_or_default();
        if self.contents_are_faulty {
            return Contents { pages, ..Contents::default() };
        }
        let tape = self.fanuc.as_mut().and_then(|fanuc| fanuc.take_tape());
        let files = self.outlines.len();
        let outlines = core::mem::replace(&mut self.outlines, vec![None; files]);
        Contents { outlines, tape, pages }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Replace these bytes by others; what an editor says of it.
    pub(crate) fn replace(
        text: &mut String,
        at: core::ops::Range<usize>,
        new: &str,
    ) -> (Shift, At) {
        let count = |text: &str| i32::try_from(text.matches('\n').count()).unwrap();
        let first = text[..at.start].rfind('\n').map_or(0, |newline| newline + 1);
        let line = 1 + count(&text[..first]).unsigned_abs();
        let lines = count(new) - count(&text[at.clone()]);
        let [from, old_end, new_end] =
            [at.start, at.end, at.start + new.len()].map(|byte| byte as u32);
        let begins_line = |byte: usize| byte == 0 || text.as_bytes()[byte - 1] == b'\n';
        let whole_lines =
            begins_line(at.start) && begins_line(at.end) && (new.is_empty() || new.ends_with('\n'));
        text.replace_range(at, new);
        (Shift { from, old_end, new_end, lines, whole_lines }, (first as u32, line))
    }

    const STEERING: &[&str] = &[
        "WHILE[#1LT3]DO1",
        "END1",
        "DO2",
        "END2",
        "N5X1.",
        "N6",
        "X1.",
        "",
        "%",
        "O7",
        "DO1",
        "DO1[",
        "M99",
    ];
    const O_WORDS: &[&str] =
        &["o1 if [1]", "o1 endif", "o2 repeat [2]", "o2 endrepeat", "X1", "", "o1 else", "o3 sub"];

    fn texts(
        menu: &'static [&'static str],
        most: usize,
    ) -> impl proptest::strategy::Strategy<Value = String> {
        use proptest::prelude::*;
        let lines = prop::collection::vec(prop::sample::select(menu), 0..most);
        lines.prop_map(|lines| lines.iter().fold(String::new(), |text, line| text + line + "\n"))
    }

    fn says_something(tape: &str) -> bool {
        tape.lines().any(|line| line == "X1." || line == "M99")
    }

    /// A stretch of the text: whole lines, if it is to be.
    fn stretch(text: &str, from: usize, length: usize, whole: bool) -> core::ops::Range<usize> {
        let place =
            |at: usize| if whole { text[..at].rfind('\n').map_or(0, |at| at + 1) } else { at };
        let from = from % (text.len() + 1);
        let to = (from + length).min(text.len());
        place(from)..place(to)
    }

    proptest::proptest! {
        #![proptest_config(proptest::test_runner::Config { failure_persistence: None, ..Default::default() })]

        #[test]
        fn a_tape_is_edited_to_what_it_would_be_read_as(
            text in texts(STEERING, 30),
            edits in proptest::collection::vec((0usize..300, 0usize..20, texts(STEERING, 4), proptest::bool::ANY), 1..5),
        ) {
            let read = |text: &str| Tape::of(&[text.as_bytes()], &[String::new()], None);
            let mut text = format!("O1\n{text}");
            for (from, length, new, whole) in &edits {
                let (tape, faults) = read(&text);
                let begins = says_something(&text);
                let at = stretch(&text, *from, *length, *whole);
                let (shift, first) = replace(&mut text, at, new);
                let edited = tape.edited(&Edited::of(text.as_bytes(), &shift, first));
                let (anew, found) = read(&text);
                // where nothing is executed it does not matter where that begins
                if let Some((tape, _)) = edited && faults.is_empty() && begins && says_something(&text) {
                    assert_eq!(tape, anew, "{text}");
                    assert!(found.is_empty(), "{text}");
                }
            }
        }

        #[test]
        fn so_is_an_outline(
            text in texts(O_WORDS, 20),
            edits in proptest::collection::vec((0usize..300, 0usize..20, texts(O_WORDS, 4), proptest::bool::ANY), 1..5),
        ) {
            let read = |text: &str| Outline::of(text.as_bytes(), 0);
            let mut text = text;
            for (from, length, new, whole) in &edits {
                let (outline, faults) = read(&text);
                let at = stretch(&text, *from, *length, *whole);
                let (shift, first) = replace(&mut text, at, new);
                let edited = outline.edited(&Edited::of(text.as_bytes(), &shift, first));
                let (anew, found) = read(&text);
                if let Some(outline) = edited && faults.is_empty() {
                    assert_eq!(format!("{:?}", outline.marks), format!("{:?}", anew.marks), "{text}");
                    assert!(found.is_empty(), "{text}");
                }
            }
        }
    }
}

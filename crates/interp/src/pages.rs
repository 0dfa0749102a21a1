//! The program's blocks, kept as they were read while its text is edited.
//!
//! ```text
//!   text    ├── page ──┤├── page ──┤├── page ──┤        each some hundred lines
//!   edit    ├── page ──┤ ✎          ├── page ──┤        those behind it move, what it touched is read again
//! ```
//!
//! Whoever shows how a program stands executes it over and over, with an edit between: and reading a line costs as
//! much as executing it.
use crate::{contents::Edited, outline::At};
use gcode::{Block, Grammar, Page, Parser};

/// Lines of a page.
const LINES: u32 = 256;
/// Ends of jumps that are remembered: a call comes back to where it left, a loop to where it began.
const LEFT: usize = 8;

/// Pages in the order of the text; between them may be what nobody has read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pages {
    held: Vec<Held>,
    /// Where the next block is if it follows the last one: its page and its place there.
    next: (usize, usize),
    /// Blocks that were left by a jump, or come to by one, the last ones: their bytes and where they are.
    left: [(u32, (usize, usize)); LEFT],
    oldest: usize,
}

#[derive(Clone, Debug)]
struct Held {
    at: At,
    page: Page,
}

impl Held {
    /// Where a block begins.
    fn begin(&self, block: usize) -> At {
        let (bytes, lines) = self.page.begin(block);
        (self.at.0 + bytes, self.at.1 + lines)
    }

    fn end(&self) -> At {
        self.begin(self.page.blocks())
    }
}

impl Pages {
    /// As [`Parser::next`], of the text `source`.
    pub(crate) fn next(
        &mut self,
        source: &[u8],
        grammar: Grammar,
        parser: &mut Parser<'_>,
        block: &mut Block,
    ) -> bool {
        let at = parser.position();
        if !self.is_next(at.0) && !self.find(at.0) {
            if at.0 as usize >= source.len() {
                return parser.next(block);
            }
            self.read(source, grammar, at);
        }
        let (place, i) = self.next;
        let held = &self.held[place];
        let whole = held.page.load(i, held.at, block);
        self.next = if i + 1 < held.page.blocks() { (place, i + 1) } else { (place + 1, 0) };
        if !whole {
            return parser.next(block);
        }
        let after = held.begin(i + 1);
        parser.seek(after.0, after.1);
        true
    }

    fn is_next(&self, byte: u32) -> bool {
        let (place, i) = self.next;
        self.held.get(place).is_some_and(|held| i < held.page.blocks() && held.begin(i).0 == byte)
    }

    /// Find the block that begins at this byte.
    fn find(&mut self, byte: u32) -> bool {
        let from = self.next;
        if let Some((_, place)) = self.left.iter().find(|(left, _)| *left == byte) {
            self.next = *place;
            if self.is_next(byte) {
                self.remember(from);
                return true;
            }
        }
        let found = self.search(byte);
        if found {
            self.remember(from);
            self.remember(self.next);
        }
        found
    }

    fn remember(&mut self, (place, i): (usize, usize)) {
        let Some(held) = self.held.get(place) else { return };
        let left = (held.begin(i).0, (place, i));
        if !self.left.contains(&left) {
            self.left[self.oldest] = left;
            self.oldest = (self.oldest + 1) % LEFT;
        }
    }

    fn search(&mut self, byte: u32) -> bool {
        let behind = self.held.partition_point(|held| held.at.0 <= byte);
        let Some(place) = behind.checked_sub(1) else { return false };
        let held = &self.held[place];
        let Some(i) = held.page.at(byte - held.at.0) else { return false };
        self.next = (place, i);
        true
    }

    /// A new page begins here.
    fn read(&mut self, source: &[u8], grammar: Grammar, at: At) {
        // no block begins here in what is kept: it was read from elsewhere
        self.held.retain(|held| at.0 < held.at.0 || held.end().0 <= at.0);
        let place = self.held.partition_point(|held| held.at.0 < at.0);
        let end = self.held.get(place).map_or(u32::MAX, |next| next.at.0);
        let held = Held { at, page: Page::read(source, grammar, at, end, LINES) };
        let end = held.end().0;
        let passed = self.held[place..].iter().take_while(|next| next.at.0 < end).count();
        self.held.splice(place..place + passed, [held]);
        self.next = (place, 0);
    }

    /// Take in an edit.
    pub(crate) fn edited(&mut self, edited: &Edited<'_>) {
        let touched = |held: &Held| held.at.0 < edited.old_end && edited.first.0 < held.end().0;
        self.held.retain(|held| !touched(held));
        for held in &mut self.held {
            held.at = edited.moved(held.at);
        }
        self.next = (0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contents::tests::replace;

    /// The blocks that a text has, by pages and by reading.
    fn check(pages: &mut Pages, text: &str, grammar: Grammar) {
        let source = text.as_bytes();
        let mut parser = Parser::with_grammar(source, 0, grammar);
        let mut anew = Parser::with_grammar(source, 0, grammar);
        let (mut block, mut other) = (Block::new(), Block::new());
        while anew.next(&mut other) {
            assert!(pages.next(source, grammar, &mut parser, &mut block));
            assert_eq!(format!("{block:?}"), format!("{other:?}"));
            assert_eq!(parser.position(), anew.position());
        }
        assert!(!pages.next(source, grammar, &mut parser, &mut block));
    }

    #[test]
    fn what_lies_behind_a_jump_may_be_read_first() {
        let lines = (0..2000).map(|i| format!("G1 X{i} Y[#1+{i}] (c{i})\n"));
        let text = lines.collect::<String>();
        let mut pages = Pages::default();
        for line in [700, 1500, 702, 30] {
            let at = text.match_indices('\n').nth(line - 1).unwrap().0 + 1;
            let mut parser = Parser::new(text.as_bytes(), 0);
            let mut block = Block::new();
            parser.seek(at as u32, line as u32 + 1);
            assert!(pages.next(text.as_bytes(), Grammar::Rs274, &mut parser, &mut block));
            assert_eq!(block.to_string(), format!("G1 X{line} Y[#1+{line}] (c{line})"));
        }
        check(&mut pages, &text, Grammar::Rs274);
        check(&mut pages, &text, Grammar::Rs274);
        assert!(pages.held.windows(2).all(|two| two[0].end() == two[1].at));
    }

    proptest::proptest! {
        #[test]
        fn after_edits_they_are_those_of_the_text(
            text in "([GXYN][0-9]{1,2}|[\n;]|#1=2|(a)){0,60}",
            edits in proptest::collection::vec((0usize..200, 0usize..20, "([GXY][0-9]|[\n;(]){0,5}"), 1..6),
        ) {
            for grammar in [Grammar::Rs274, Grammar::Fanuc] {
                let mut text = text.clone();
                let mut pages = Pages::default();
                check(&mut pages, &text, grammar);
                for (at, length, new) in &edits {
                    let from = at % (text.len() + 1);
                    let to = (from + length).min(text.len());
                    let (shift, first) = replace(&mut text, from..to, new);
                    pages.edited(&Edited::of(text.as_bytes(), &shift, first));
                    check(&mut pages, &text, grammar);
                }
            }
        }
    }
}

//! Names in a program: parameters (`#<depth>`, `#5`) and O-words (`o<peck>`, `o100`), where they
//! stand and what they belong to.
//!
//! ```text
//!   #<depth> = 5             scope 0, the main program
//!   o<peck> sub              ┐
//!     #<depth> = #1          │ scope 1: another #<depth>
//!   o<peck> endsub           ┘
//!   #<_clear> = 2            global: the same everywhere
//! ```
use crate::document::Document;
use gcode::{Block, CommentKind, Grammar, Keyword, Label, Parser};
use std::ops::Range;

/// Parameters up to this one belong to a subprogram's call.
const ARGUMENTS: u32 = 30;

/// What a name is of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// `#<name>`.
    Named,
    /// `#5`.
    Numbered,
    /// Of an O-word, and what it does.
    O(Keyword),
}

/// One place where a name stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Name {
    pub(crate) kind: Kind,
    /// In lower case and without blanks; a number for numbered ones.
    pub(crate) text: String,
    /// The whole of it: `#<depth>`, `o<peck>`.
    pub(crate) from: usize,
    pub(crate) to: usize,
    /// What a new name replaces: between `<` and `>`, or the number.
    pub(crate) inner: Range<usize>,
    /// Line, from 0.
    pub(crate) line: usize,
    /// Set here, not read.
    pub(crate) set: bool,
    /// Subprogram it stands in, from 1; 0 in the main program.
    pub(crate) scope: usize,
}

impl Name {
    pub(crate) fn holds(&self, byte: usize) -> bool {
        (self.from..=self.to).contains(&byte)
    }

    /// As programs write it, if it is a parameter.
    pub(crate) fn as_parameter(&self) -> Option<String> {
        match self.kind {
            Kind::Named => Some(format!("#<{}>", self.text)),
            Kind::Numbered => Some(format!("#{}", self.text)),
            Kind::O(_) => None,
        }
    }

    /// Whether both are names of one thing.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let same_kind = match (&self.kind, &other.kind) {
            (Kind::O(_), Kind::O(_)) => return self.text == other.text,
            (a, b) => a == b,
        };
        let everywhere = match self.kind {
            Kind::Numbered => self.text.parse::<u32>().is_ok_and(|n| n > ARGUMENTS),
            _ => self.text.starts_with('_'),
        };
        same_kind && self.text == other.text && (everywhere || self.scope == other.scope)
    }
}

/// All names of the text.
pub(crate) fn all(document: &Document, grammar: Grammar) -> Vec<Name> {
    let (mut parser, mut block) = (Parser::with_grammar(&document.text, 0, grammar), Block::new());
    // a tape's programs have variables of their own
    let first = if grammar == Grammar::Fanuc { Keyword::Program } else { Keyword::Sub };
    let mut found = Vec::new();
    let (mut scope, mut subs) = (0, 0);
    while parser.next(&mut block) {
        let begins = matches!(block.o, Some(o) if o.keyword == first);
        if begins {
            subs += 1;
            scope = subs;
        }
        of_block(&document.text, &block, (scope, grammar), &mut found);
        if matches!(block.o, Some(o) if o.keyword == Keyword::EndSub) {
            scope = 0;
        }
    }
    found
}

/// The names in one line (from 0), whose scope is not known.
pub(crate) fn in_line(document: &Document, line: usize, grammar: Grammar) -> Vec<Name> {
    let (mut parser, mut block) = (Parser::with_grammar(&document.text, 0, grammar), Block::new());
    parser.seek(document.line(line).0 as u32, line as u32 + 1);
    let mut found = Vec::new();
    // a line of Fanuc's can hold several blocks
    while parser.next(&mut block) && block.span.line == line as u32 + 1 {
        of_block(&document.text, &block, (0, grammar), &mut found);
    }
    found
}

fn of_block(text: &[u8], block: &Block, (scope, grammar): (usize, Grammar), found: &mut Vec<Name>) {
    let line = (block.span.line as usize).saturating_sub(1);
    let (start, end) = (block.span.start as usize, (block.span.end as usize).min(text.len()));
    if let Some(o) = block.o {
        let name = match o.label {
            Label::Number(number) => Some(number.to_string()),
            Label::Name(name) => Some(block.text(name).to_owned()),
            Label::Computed(_) => None,
        };
        if let Some(name) = name {
            let from = o.span.start as usize;
            let head = usize::from(text.get(from) != Some(&b'<')); // O, o or :
            let inner = inner(text, from + head, end);
            let to = (inner.end + usize::from(text.get(inner.end) == Some(&b'>'))).min(end);
            let kind = Kind::O(o.keyword);
            let set = matches!(o.keyword, Keyword::Sub | Keyword::Program);
            found.push(Name { kind, text: name, from, to, inner, line, set, scope });
        }
    }
    found.extend(called(text, block, (line, scope), grammar));
    let mut at = start;
    while let Some(hash) = memchr::memchr(b'#', &text[at..end]).map(|i| at + i) {
        at = hash + 1;
        if in_words_for_people(block, hash) {
            continue;
        }
        let inner = inner(text, at, end);
        if inner.is_empty() {
            continue;
        }
        let closed = text.get(inner.end) == Some(&b'>');
        let name: String = text[inner.clone()]
            .iter()
            .filter(|b| !b.is_ascii_whitespace())
            .map(|b| b.to_ascii_lowercase() as char)
            .collect();
        let kind = if closed { Kind::Named } else { Kind::Numbered };
        let to = inner.end + usize::from(closed);
        let set = block.assignments.iter().any(|a| a.span.start as usize == hash);
        at = inner.end;
        found.push(Name { kind, text: name, from: hash, to, inner, line, set, scope });
    }
}

/// What lies between `<` and `>` after blanks, or the digits.
fn inner(text: &[u8], mut at: usize, end: usize) -> Range<usize> {
    while at < end && text[at].is_ascii_whitespace() {
        at += 1;
    }
    if text.get(at) == Some(&b'<') {
        return match memchr::memchr(b'>', &text[at..end]) {
            Some(length) => at + 1..at + length,
            None => at..at,
        };
    }
    let digits = text[at..end].iter().take_while(|b| b.is_ascii_digit()).count();
    at..at + digits
}

/// Whether a byte lies in a comment in which `#` means nothing.
fn in_words_for_people(block: &Block, byte: usize) -> bool {
    block.comments.iter().any(|comment| {
        let span = comment.span.start as usize..comment.span.end as usize;
        let speaks =
            matches!(comment.kind, CommentKind::Debug | CommentKind::Print | CommentKind::Log);
        span.contains(&byte) && !speaks
    })
}

/// Where the thing under a byte is made: the subprogram, or the first setting of the parameter.
pub(crate) fn definition(
    document: &Document,
    line: usize,
    byte: usize,
    grammar: Grammar,
) -> Option<Name> {
    let names = all(document, grammar);
    let here = names.iter().find(|name| name.line == line && name.holds(byte));
    // elsewhere in the line of a call it is the call that is meant
    let is_call = |name: &&Name| name.line == line && name.kind == Kind::O(Keyword::Call);
    let here = here.or_else(|| names.iter().find(is_call))?;
    names.iter().find(|name| name.set && name.is_same(here)).cloned()
}

/// P of `M98 P100`, and of Fanuc's `G65 P100` and `G66 P100`, or the name in its place: the program
/// that is called.
fn called(
    text: &[u8],
    block: &Block,
    (line, scope): (usize, usize),
    grammar: Grammar,
) -> Option<Name> {
    let plain = |word: &gcode::Word| match word.value {
        gcode::Value::Number(number) => Some(number),
        gcode::Value::Expression(_) => None,
    };
    let has = |letter: u8, codes: &[f64]| {
        let mut words = block.words.iter().filter(|word| word.letter == letter);
        words.any(|word| plain(word).is_some_and(|code| codes.contains(&code)))
    };
    let is_tape = grammar == Grammar::Fanuc;
    let program = has(b'M', &[98.0, 198.0]);
    if !(program || is_tape && has(b'G', &[65.0, 66.0])) {
        return None;
    }
    let name = |text: String, from: usize, inner: Range<usize>, to: usize| {
        let kind = Kind::O(Keyword::Call);
        Some(Name { kind, text, from, to, inner, line, set: false, scope })
    };
    if let Some(called) = block.called {
        let end = (block.span.end as usize).min(text.len());
        let open = block.span.start as usize
            + memchr::memchr(b'<', &text[block.span.start as usize..end])?;
        let inner = inner(text, open, end);
        let to = inner.end + 1;
        return name(block.text(called).to_owned(), open, inner, to);
    }
    let word = block.word(b'P')?;
    let (from, end) = (word.span.start as usize, (word.span.end as usize).min(text.len()));
    let number = plain(word).filter(|n| n.fract() == 0.0 && (0.0..4e9).contains(n))? as u32;
    let digits = text[from..end].iter().rev().take_while(|b| b.is_ascii_digit()).count();
    // P51002: five times O1002
    let repeats = is_tape && program && number > 9999 && block.word(b'L').is_none();
    let (number, digits) =
        if repeats { (number % 10_000, digits.min(4)) } else { (number, digits) };
    name(number.to_string(), from, end - digits..end, end)
}

/// All places of the thing under a byte.
pub(crate) fn same(document: &Document, line: usize, byte: usize, grammar: Grammar) -> Vec<Name> {
    let names = all(document, grammar);
    let Some(here) = names.iter().find(|name| name.line == line && name.holds(byte)).cloned()
    else {
        return Vec::new();
    };
    names.into_iter().filter(|name| name.is_same(&here)).collect()
}

/// Whether something else has this name already, where the old one is known: both would become one.
pub(crate) fn taken(document: &Document, old: &Name, new: &str, grammar: Grammar) -> bool {
    let wanted = Name { text: new.to_ascii_lowercase(), ..old.clone() };
    wanted.text != old.text && all(document, grammar).iter().any(|name| name.is_same(&wanted))
}

/// Whether a new name can take the old one's place, or why not.
pub(crate) fn acceptable(old: &Name, new: &str) -> Result<String, String> {
    let new: String = new.chars().filter(|c| !c.is_whitespace()).collect();
    let bare = new.trim_start_matches(['#', 'o', 'O']).to_owned();
    let new = match bare.strip_prefix('<').and_then(|n| n.strip_suffix('>')) {
        Some(inner) => inner.to_owned(),
        None => new,
    };
    let numbered = old.text.bytes().all(|b| b.is_ascii_digit());
    let new = if numbered { bare.clone() } else { new };
    let fine = if numbered {
        new.parse::<u32>().is_ok()
    } else {
        !new.is_empty() && new.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    if !fine && numbered {
        return Err(format!("expected a whole number in the place of {}, found {new}", old.text));
    }
    if !fine {
        return Err(format!("expected letters, digits and _ in a name, found {new}"));
    }
    if matches!(old.kind, Kind::Named) && old.text.starts_with('_') != new.starts_with('_') {
        let text = "names that begin with _ are known everywhere, others in their subprogram only: \
                    the new name must begin as the old one";
        return Err(text.to_owned());
    }
    Ok(new)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lsp_types::PositionEncodingKind;

    fn open(text: &str) -> Document {
        Document::new(text.to_owned(), &PositionEncodingKind::UTF16)
    }

    #[test]
    fn a_local_name_belongs_to_its_subprogram() {
        let text = "#<d>=1\no1 sub\n#<d>=2 #<_g>=#< D >\no1 endsub\nG0 X#<d> Y#<_g>\n(DEBUG, #<d>)\n(#<d>)\n";
        let document = open(text);
        let lines = |line, byte_of: &str| -> Vec<usize> {
            let (from, _) = document.line(line);
            let at = from + text[from..].find(byte_of).unwrap_or(0);
            same(&document, line, at, Grammar::Rs274).iter().map(|name| name.line).collect()
        };
        assert_eq!(lines(0, "#<d>"), [0, 4, 5]);
        assert_eq!(lines(2, "#< D >"), [2, 2]);
        assert_eq!(lines(4, "#<_g>"), [2, 4]);
    }

    #[test]
    fn a_subprogram_is_found_from_its_call() {
        let document = open("o<hole> sub\no<hole> endsub\no<hole> call [1]\nM98 P7\nO7\nM99\n");
        let line =
            |line, byte| definition(&document, line, byte, Grammar::Rs274).map(|name| name.line);
        let call = document.line(2).0;
        assert_eq!(line(2, call + 3), Some(0));
        assert_eq!(line(3, document.line(3).0 + 1), Some(4));
    }

    #[test]
    fn variables_of_a_tape_belong_to_their_program() {
        let text = "O1\n#1=2\n#100=#1\nG65 P2 A1.\nM30\nO2\nIF [#1 GT #100] GOTO 9\nN9 M99\n";
        let document = open(text);
        let lines = |line: usize, of: &str| -> Vec<usize> {
            let (from, _) = document.line(line);
            let at = from + text[from..].find(of).unwrap_or(0);
            same(&document, line, at, Grammar::Fanuc).iter().map(|name| name.line).collect()
        };
        assert_eq!(lines(1, "#1"), [1, 2]);
        assert_eq!(lines(6, "#1"), [6]);
        assert_eq!(lines(2, "#100"), [2, 6]);
        let two = open("O1\n#100=1;#101=2\nM30\n");
        let there = in_line(&two, 1, Grammar::Fanuc);
        assert_eq!(there.iter().map(|name| name.text.as_str()).collect::<Vec<_>>(), ["100", "101"]);
        let text = "O1\nM98 P2 L3\nM98 P0040002\nG65 P2 A1.\nM30\nO0002\nM99\n";
        let calls = open(text);
        let all = same(&calls, 5, calls.line(5).0 + 2, Grammar::Fanuc);
        let parts: Vec<_> = all.iter().map(|name| &text[name.inner.clone()]).collect();
        assert_eq!(parts, ["2", "0002", "2", "0002"]);
        let named = open("O1\nG0 X1.; M98 <SUB>\nM30\n<SUB>\nM99\n");
        let begin = definition(&named, 1, named.line(1).0 + 12, Grammar::Fanuc);
        assert_eq!(begin.map(|name| name.line), Some(3));
        let called = definition(&document, 3, document.line(3).0 + 4, Grammar::Fanuc);
        assert_eq!(called.map(|name| name.line), Some(5));
    }

    #[test]
    fn a_new_name_must_be_one_that_can_be_written() {
        let document = open("#<d>=1\n");
        let name = all(&document, Grammar::Rs274).remove(0);
        assert_eq!(acceptable(&name, "depth"), Ok("depth".to_owned()));
        assert_eq!(acceptable(&name, "#<depth>"), Ok("depth".to_owned()));
        assert!(taken(&open("#<d>=1\n#<depth>=2\n"), &name, "depth", Grammar::Rs274));
        assert!(!taken(&open("#<d>=1\no1 sub\n#<depth>=2\n"), &name, "depth", Grammar::Rs274));
        let number = all(&open("#5=1\n"), Grammar::Rs274).remove(0);
        assert_eq!(acceptable(&number, "#7"), Ok("7".to_owned()));
        assert_eq!(acceptable(&number, "7"), Ok("7".to_owned()));
        assert!(acceptable(&number, "x").is_err());
        assert!(acceptable(&name, "_depth").is_err());
        assert!(acceptable(&name, "de-pth").is_err());
    }
}

//! What can be wrong with a line: the one home of this crate's codes and sentences.
//!
//! A problem is small and carries no text while it travels up through the parser; the sentence is
//! made once, here, from the line it was found in. Codes are stable: people search for them.

use crate::fanuc::Grammar;
use crate::{MAX_LINE_BYTES, MAX_NESTING, MAX_OPERATIONS};
use diag::{Diagnostic, Span};

/// One kind of problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Problem {
    NumberAfter(u8),
    BadNumber,
    NumberTooLarge,
    WordExpected,
    LetterTwice(u8),
    NumberNotFirst,
    OWordNotFirst,
    EndAfterOWord,
    EndAfterControl,
    ThenExpected,
    DoExpected,
    LevelExpected,
    DeleteNotFirst,
    PercentNotAlone,
    CommentNotClosed,
    CommentInComment,
    CommentNotOpen,
    ValueExpected,
    OperatorExpected,
    BracketAfter(&'static str),
    UnknownFunction(Grammar),
    AtanNeedsTwo,
    PowNeedsTwo,
    CommaWord,
    OutputText,
    ExistsNeedsParameter,
    TooDeep,
    TooManyOperations,
    NameNotClosed,
    NameEmpty,
    NameCharacter,
    EqualsExpected,
    LabelExpected,
    LabelNotWhole,
    KeywordUnknown,
    LineTooLong,
    Binary,
    NotText,
    ForTheSender,
    BehindSemicolon,
    BehindPercent,
    BeforePercent,
    LoneReturn,
    CommentNotUtf8,
    FileTooLong,
    More(usize),
}

/// A problem and the bytes of the line it lies in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fault {
    pub(crate) problem: Problem,
    pub(crate) from: usize,
    pub(crate) to: usize,
}

fn number_after(letter: char, found: &str) -> String {
    if found.eq_ignore_ascii_case("\"O\"") {
        return format!(
            "expected a number after {letter}, found the letter O: {letter}0 has a zero"
        );
    }
    format!("expected a number after {letter}, found {found}")
}

impl Problem {
    /// The stable code.
    pub(crate) const fn code(self) -> &'static str {
        match self {
            Self::NumberAfter(_) => "P0101",
            Self::BadNumber => "P0102",
            Self::NumberTooLarge => "P0103",
            Self::WordExpected => "P0104",
            Self::LetterTwice(_) => "P0105",
            Self::NumberNotFirst => "P0106",
            Self::OWordNotFirst => "P0107",
            Self::EndAfterOWord => "P0108",
            Self::DeleteNotFirst => "P0109",
            Self::PercentNotAlone => "P0110",
            Self::CommentNotClosed => "P0111",
            Self::CommentInComment => "P0112",
            Self::CommentNotOpen => "P0113",
            Self::ValueExpected => "P0120",
            Self::OperatorExpected => "P0121",
            Self::BracketAfter(_) => "P0122",
            Self::UnknownFunction(_) => "P0123",
            Self::AtanNeedsTwo => "P0124",
            Self::PowNeedsTwo => "P0128",
            Self::CommaWord => "P0154",
            Self::OutputText => "P0155",
            Self::ExistsNeedsParameter => "P0125",
            Self::TooDeep => "P0126",
            Self::TooManyOperations => "P0127",
            Self::NameNotClosed => "P0130",
            Self::NameEmpty => "P0131",
            Self::NameCharacter => "P0132",
            Self::EqualsExpected => "P0133",
            Self::LabelExpected => "P0140",
            Self::LabelNotWhole => "P0141",
            Self::KeywordUnknown => "P0142",
            Self::EndAfterControl => "P0150",
            Self::ThenExpected => "P0151",
            Self::DoExpected => "P0152",
            Self::LevelExpected => "P0153",
            Self::LineTooLong => "P0190",
            Self::Binary => "P0191",
            Self::NotText => "P0192",
            Self::ForTheSender => "P0196",
            Self::BehindSemicolon => "P0197",
            Self::BehindPercent | Self::BeforePercent => "P0198",
            Self::LoneReturn => "P0193",
            Self::CommentNotUtf8 => "P0194",
            Self::FileTooLong => "P0195",
            Self::More(_) => "P0199",
        }
    }

    /// The sentence; `here` is the text that the fault marks, `found` what stands there.
    fn message(self, here: &str, found: &str) -> String {
        match self {
            Self::NumberAfter(letter) => number_after(letter as char, found),
            Self::BadNumber => {
                format!("expected a number such as 1.5 or -.25, found \"{here}\"")
            }
            Self::NumberTooLarge => {
                "this number is too large: the largest is about 1.8 times 10 to the 308th".into()
            }
            Self::WordExpected => {
                format!("expected a word such as X1.5 or the end of the line, found {found}")
            }
            Self::LetterTwice(letter) => {
                format!("{} is given twice in this block: leave one of them", letter as char)
            }
            Self::NumberNotFirst => "expected N only at the beginning of its line".into(),
            Self::OWordNotFirst => {
                "expected an O-word only at the beginning of its line, after N at most".into()
            }
            Self::EndAfterOWord => {
                format!("expected the end of the line after the O-word, found {found}")
            }
            Self::EndAfterControl => {
                format!("expected the end of the block after GOTO, WHILE, DO or END, found {found}")
            }
            Self::ThenExpected => format!("expected GOTO or THEN after IF [...], found {found}"),
            Self::DoExpected => {
                format!("expected DO1, DO2 or DO3 after WHILE [...], found {found}")
            }
            Self::LevelExpected => format!("expected 1, 2 or 3 after DO and END, found {found}"),
            Self::DeleteNotFirst => "expected \"/\" only at the very beginning of a line".into(),
            Self::PercentNotAlone => "expected \"%\" alone on its line".into(),
            Self::CommentNotClosed => {
                "expected \")\" before the end of the line: this comment is not closed".into()
            }
            Self::CommentInComment => {
                "expected \")\" before the next \"(\": a comment holds no other comment".into()
            }
            Self::CommentNotOpen => "found \")\" without the \"(\" of a comment before it".into(),
            Self::ValueExpected => {
                format!("expected a number, a parameter (#), a function or \"[\", found {found}")
            }
            Self::OperatorExpected if here.eq_ignore_ascii_case("e") => {
                "expected an operator or \"]\", found an exponent: write the number out, 2500 for 2.5E3".into()
            }
            Self::OperatorExpected => format!("expected an operator or \"]\", found {found}"),
            Self::BracketAfter(what) => format!("expected \"[\" after {what}, found {found}"),
            Self::UnknownFunction(grammar) => {
                format!("expected {}, found \"{here}\"", listed(functions(grammar)))
            }
            Self::PowNeedsTwo => "expected two arguments, as in POW[2,3]".into(),
            Self::CommaWord => {
                format!("expected C (chamfer), R (corner radius) or A (angle) after the comma, found {found}")
            }
            Self::OutputText => format!(
                "expected text with * for a blank, or a variable with its digits as in #1[53], in \
                 DPRNT[...] and BPRNT[...], found {found}"
            ),
            Self::AtanNeedsTwo => format!("expected \"/[\" after ATAN[...], found {found}"),
            Self::ExistsNeedsParameter => {
                format!("expected a parameter such as #<name> in EXISTS[...], found {found}")
            }
            Self::TooDeep => format!("expected at most {MAX_NESTING} levels of nesting"),
            Self::TooManyOperations => {
                format!("expected at most {MAX_OPERATIONS} operations in one expression")
            }
            Self::NameNotClosed => "expected \">\" at the end of this name".into(),
            Self::NameEmpty => "expected a name between \"<\" and \">\"".into(),
            Self::NameCharacter => {
                format!("expected letters, digits and \"_\" in a name, found {found}")
            }
            Self::EqualsExpected => {
                format!("expected \"=\" after the parameter to be set, found {found}")
            }
            Self::LabelExpected => {
                format!("expected a number, <name> or [expression] after O, found {found}")
            }
            Self::LabelNotWhole => {
                format!("expected a whole number from 0 to {} after O, found \"{here}\"", u32::MAX)
            }
            Self::KeywordUnknown => format!(
                "expected sub, endsub, return, call, if, elseif, else, endif, while, endwhile, do, \
                 repeat, endrepeat, break or continue after the O-word, found {found}"
            ),
            Self::LineTooLong => {
                format!("expected lines of at most {MAX_LINE_BYTES} bytes: this one is longer")
            }
            Self::Binary => "expected a text file, found a NUL byte: this is binary data".into(),
            Self::ForTheSender => format!("{here} is for a sender, its controller or a simulator, and is left out"),
            Self::BehindPercent => format!("{here} stands in the line of the percent sign: it is not read"),
            Self::BeforePercent => "this stands before the percent sign, where a tape has its leader: it is not read".into(),
            Self::BehindSemicolon => "behind the semicolon stands no block: it is left out".into(),
            Self::NotText => format!("expected plain ASCII text outside comments, found {found}"),
            Self::LoneReturn => "expected lines that end with LF or CR LF, found a CR in the middle".into(),
            Self::CommentNotUtf8 => {
                "this comment is not UTF-8: its other characters are shown as \u{fffd}".into()
            }
            Self::FileTooLong => "expected a file of less than 4 GiB: this one is longer".into(),
            Self::More(count) => format!("and {count} more, like these"),
        }
    }

    /// The finding, for people: `line` is the text of the whole line, `span` of its faulty part.
    pub(crate) fn diagnostic(self, line: &[u8], from: usize, span: Span) -> Diagnostic {
        let to = (from + (span.end - span.start) as usize).min(line.len());
        let here = String::from_utf8_lossy(line.get(from..to.min(from + 40)).unwrap_or_default());
        let message = self.message(&here, &found(line, from));
        match self {
            Self::CommentNotUtf8 => Diagnostic::note(self.code(), span, message),
            Self::ForTheSender => Diagnostic::note(self.code(), span, message)
                .with_help("do by hand what it asks for, if it is needed. Said once"),
            Self::BehindPercent => Diagnostic::warning(self.code(), span, message).with_help(
                "Fanuc's controls skip what stands beside it: write the program's number in a line of its own. Said once",
            ),
            Self::BeforePercent => Diagnostic::warning(self.code(), span, message)
                .with_help("Fanuc's controls skip what comes before the first percent sign. Said once"),
            Self::BehindSemicolon => Diagnostic::warning(self.code(), span, message)
                .with_help("Fanuc's controls have comments in brackets, (like this). Said once"),
            Self::UnknownFunction(_) | Self::KeywordUnknown => {
                let finding = Diagnostic::error(self.code(), span, message);
                let names = match self {
                    Self::UnknownFunction(grammar) => functions(grammar),
                    _ => KEYWORDS,
                };
                match nearest(&letters_at(line, from), names) {
                    Some(near) => finding.with_help(format!("did you mean {near}?")),
                    None => finding,
                }
            }
            Self::CommentNotClosed => Diagnostic::error(self.code(), span, message)
                .with_help("a comment ends on the line it begins on; \";\" needs no end"),
            _ => Diagnostic::error(self.code(), span, message),
        }
    }
}

/// Functions, for who has misspelled one.
const FUNCTIONS: &[&str] = &[
    "ABS", "ACOS", "ASIN", "ATAN", "COS", "EXISTS", "EXP", "FIX", "FUP", "LN", "ROUND", "SIN",
    "SQRT", "TAN",
];
/// The same of Fanuc's grammar.
const FANUC_FUNCTIONS: &[&str] = &[
    "ABS", "ACOS", "ASIN", "ATAN", "BCD", "BIN", "COS", "EXP", "FIX", "FUP", "LN", "POW", "ROUND",
    "SIN", "SQRT", "TAN",
];
/// What O-words do, for who has misspelled it.
const KEYWORDS: &[&str] = &[
    "sub",
    "endsub",
    "return",
    "call",
    "if",
    "elseif",
    "else",
    "endif",
    "while",
    "endwhile",
    "do",
    "repeat",
    "endrepeat",
    "break",
    "continue",
];

const fn functions(grammar: Grammar) -> &'static [&'static str] {
    match grammar {
        Grammar::Rs274 | Grammar::Grbl => FUNCTIONS,
        Grammar::Fanuc => FANUC_FUNCTIONS,
    }
}

/// `A, B or C`.
fn listed(names: &[&str]) -> String {
    match names {
        [most @ .., last] => format!("{} or {last}", most.join(", ")),
        [] => String::new(),
    }
}

/// The letters at a place.
fn letters_at(line: &[u8], from: usize) -> String {
    let rest = line.get(from..).unwrap_or_default();
    rest.iter().take(16).take_while(|b| b.is_ascii_alphabetic()).map(|b| *b as char).collect()
}

/// The name that a misspelled one is nearest to: two letters inserted, deleted or replaced at most,
/// one in a short name.
fn nearest(word: &str, names: &[&'static str]) -> Option<&'static str> {
    let rated = names.iter().map(|name| (edits(word, name), *name));
    let (distance, name) = rated.min_by_key(|(distance, _)| *distance)?;
    (distance * 3 <= name.len() && distance < word.len()).then_some(name)
}

/// Letters to insert, delete or replace to make one word of the other, whatever their case
/// (Levenshtein).
fn edits(a: &str, b: &str) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.bytes().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.bytes().enumerate() {
            let replaced = diagonal + usize::from(!from.eq_ignore_ascii_case(&to));
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

/// What stands at `from`, in words: `"Y"`, `"foo"`, `byte 0xE9`, `the end of the line`.
fn found(line: &[u8], from: usize) -> String {
    let rest = line.get(from..).unwrap_or_default();
    let Some(&first) = rest.first() else { return "the end of the line".into() };
    let letters = rest.iter().take(16).take_while(|b| b.is_ascii_alphabetic()).count();
    let valid = match core::str::from_utf8(&rest[..rest.len().min(4)]) {
        Ok(text) => text,
        Err(e) => core::str::from_utf8(&rest[..e.valid_up_to()]).unwrap_or(""),
    };
    match valid.chars().next() {
        Some(_) if letters > 1 => {
            format!("\"{}\"", String::from_utf8_lossy(&rest[..letters]))
        }
        Some(c) if !c.is_control() => format!("\"{c}\""),
        _ => format!("byte 0x{first:02X}"),
    }
}

//! Comments: `(words)` and `; words`, and the few that ask for something.
//!
//! A comment asks for something when it begins with a keyword and a comma: `(MSG, load tool 3)`.
//! The keyword may follow blanks and be in any case, but has no blanks inside. After a semicolon
//! only `py,` is a keyword; the rest of such a line is for people.

use crate::block::{Comment, CommentKind, Text};
use crate::fanuc::Grammar;
use crate::line::{Line, Read};
use crate::problem::{Fault, Problem};

/// The keywords that end with a comma or stand alone, and what they ask for.
const KEYWORDS: [(&str, CommentKind); 11] = [
    ("MSG,", CommentKind::Message),
    ("DEBUG,", CommentKind::Debug),
    ("PRINT,", CommentKind::Print),
    ("LOG,", CommentKind::Log),
    ("LOGOPEN,", CommentKind::LogOpen),
    ("LOGAPPEND,", CommentKind::LogAppend),
    ("LOGCLOSE", CommentKind::LogClose),
    ("PROBEOPEN", CommentKind::ProbeOpen),
    ("PROBECLOSE", CommentKind::ProbeClose),
    ("ABORT,", CommentKind::Abort),
    ("PY,", CommentKind::Python),
];

impl CommentKind {
    /// The keyword as it is written, with its comma; nothing for a plain comment.
    #[must_use]
    pub fn keyword(self) -> &'static str {
        KEYWORDS.iter().find(|(_, kind)| *kind == self).map_or("", |(word, _)| word)
    }
}

/// What the text in brackets asks for, and how many of its bytes say so.
fn kind_of(text: &str) -> (CommentKind, usize) {
    let words = text.trim_start_matches([' ', '\t']);
    let blanks = text.len() - words.len();
    for (keyword, kind) in KEYWORDS {
        let begin = words.get(..keyword.len()).unwrap_or("");
        let next = words.as_bytes().get(keyword.len()).copied().unwrap_or(b' ');
        let ended = keyword.ends_with(',') || !next.is_ascii_alphanumeric();
        if ended && begin.eq_ignore_ascii_case(keyword) {
            return (kind, blanks + keyword.len());
        }
    }
    (CommentKind::Plain, 0)
}

impl Line<'_, '_> {
    /// `(...)`: the `(` comes next.
    pub(crate) fn bracket_comment(&mut self) -> Read<()> {
        let open = self.at;
        self.take();
        let rest = &self.text[self.at..];
        let length = if self.grammar == Grammar::Grbl {
            memchr::memchr(b')', rest) // up to the first one, whatever stands before it
        } else {
            memchr::memchr2(b'(', b')', rest)
        };
        match length {
            Some(length) if self.text[self.at + length] == b')' => {
                self.comment(open, self.at, self.at + length, false)?;
                self.take();
                Ok(())
            }
            Some(length) => {
                self.at += length;
                self.fault_here(Problem::CommentInComment)
            }
            None => {
                self.end = self.text.len();
                self.fault_since(Problem::CommentNotClosed, open)
            }
        }
    }

    /// `;...`: the `;` comes next.
    pub(crate) fn line_comment(&mut self) -> Read<()> {
        let open = self.at;
        self.take();
        self.comment(open, self.at, self.text.len(), true)
    }

    fn comment(&mut self, open: usize, from: usize, to: usize, semicolon: bool) -> Read<()> {
        let bytes = &self.text[from..to];
        if let Some(at) = memchr::memchr2(0, b'\r', bytes) {
            let problem = if bytes[at] == 0 { Problem::Binary } else { Problem::LoneReturn };
            return Err(Fault { problem, from: from + at, to: from + at + 1 });
        }
        let text = String::from_utf8_lossy(bytes);
        if let std::borrow::Cow::Owned(_) = text {
            self.remark = Some(Fault { problem: Problem::CommentNotUtf8, from: open, to });
        }
        let (kind, skip) = match kind_of(&text) {
            _ if self.grammar == Grammar::Fanuc => (CommentKind::Plain, 0),
            (kind, _) if semicolon && kind != CommentKind::Python => (CommentKind::Plain, 0),
            found => found,
        };
        let start = self.block.texts.len() as u32;
        self.block.texts.push_str(&text[skip..]);
        let text = Text { start, end: self.block.texts.len() as u32 };
        (self.at, self.end) = (to, to);
        let mut span = self.span(open);
        span.end += u32::from(!semicolon);
        self.block.comments.push(Comment { kind, text, semicolon, span });
        Ok(())
    }
}

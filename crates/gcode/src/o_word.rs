//! O-words: the lines that steer a program.
//!
//! ```text
//!   o-line = "o" ( number | "<" name ">" | "[" expression "]" | "#" parameter ) [ keyword { "[" expression "]" } ]
//! ```
//!
//! How many arguments a keyword takes is a matter of form and is checked here; whether an `endif`
//! has its `if` is not.

use crate::block::{Keyword, Label, OWord};
use crate::expression::Value;
use crate::line::{Line, Read};
use crate::problem::Problem;

/// Name, keyword, and the least and the largest number of arguments.
const KEYWORDS: [(&str, Keyword, usize, usize); 15] = [
    ("sub", Keyword::Sub, 0, 0),
    ("endsub", Keyword::EndSub, 0, 1),
    ("return", Keyword::Return, 0, 1),
    ("call", Keyword::Call, 0, usize::MAX),
    ("if", Keyword::If, 1, 1),
    ("elseif", Keyword::ElseIf, 1, 1),
    ("else", Keyword::Else, 0, 0),
    ("endif", Keyword::EndIf, 0, 0),
    ("while", Keyword::While, 1, 1),
    ("endwhile", Keyword::EndWhile, 0, 0),
    ("do", Keyword::Do, 0, 0),
    ("repeat", Keyword::Repeat, 1, 1),
    ("endrepeat", Keyword::EndRepeat, 0, 0),
    ("break", Keyword::Break, 0, 0),
    ("continue", Keyword::Continue, 0, 0),
];

impl Keyword {
    /// As it is written; nothing for [`Keyword::Program`].
    #[must_use]
    pub fn text(self) -> &'static str {
        KEYWORDS.iter().find(|(_, keyword, ..)| *keyword == self).map_or("", |(text, ..)| text)
    }
}

impl Line<'_, '_> {
    /// The O-word and its arguments: the `O` comes next.
    pub(crate) fn o_word(&mut self) -> Read<()> {
        let from = self.start();
        self.take();
        let label = self.label()?;
        let keyword = self.keyword()?;
        self.block.o = Some(OWord { label, keyword, span: self.span(from) });
        Ok(())
    }

    pub(crate) fn label(&mut self) -> Read<Label> {
        let from = self.start();
        match self.peek() {
            b'<' => Ok(Label::Name(self.name()?)),
            b'[' | b'#' => Ok(Label::Computed(self.whole_value()?)),
            b'0'..=b'9' | b'.' | b'+' | b'-' => {
                let number = self.number()?;
                if number.fract() != 0.0 || !(0.0..=f64::from(u32::MAX)).contains(&number) {
                    return self.fault_since(Problem::LabelNotWhole, from);
                }
                Ok(Label::Number(number as u32))
            }
            _ => self.fault_here(Problem::LabelExpected),
        }
    }

    fn keyword(&mut self) -> Read<Keyword> {
        let from = self.start();
        let mut buffer = [0; 16];
        let count = self.letters(&mut buffer);
        let name = &buffer[..count];
        let known = KEYWORDS.iter().find(|(text, ..)| text.as_bytes().eq_ignore_ascii_case(name));
        let Some(&(text, keyword, least, most)) = known else {
            if name.is_empty() && matches!(self.peek(), 0 | b'(' | b';') {
                return Ok(Keyword::Program);
            }
            self.at = from;
            return self.fault_here(Problem::KeywordUnknown);
        };
        if self.head_only && matches!(keyword, Keyword::Call | Keyword::Return) {
            self.at = self.text.len();
            return Ok(keyword);
        }
        while self.block.arguments.len() < most {
            match self.peek() {
                b'[' => {
                    let argument: Value = self.whole_value()?;
                    self.block.arguments.push(argument);
                }
                b'(' => self.bracket_comment()?,
                _ => break,
            }
        }
        if self.block.arguments.len() < least {
            return self.fault_here(Problem::BracketAfter(text));
        }
        Ok(keyword)
    }
}

//! One line of a text as letters and numbers, read without a grammar.
use crate::dialect::rules::Family;
use diag::Span;

/// Lines and bytes that are looked at.
pub(crate) const LINES: usize = 4000;
pub(crate) const BYTES: u32 = 1 << 18;
/// Bytes of a line that are looked at: a longer one tells nothing more, and is refused.
const OF_A_LINE: usize = 1 << 12;

/// A control's name, whose it is, and what that is evidence of.
pub(crate) type ControlName = (&'static str, Family, &'static str);

pub(crate) const NAMES: [ControlName; 3] = [
    ("Grbl", Family::Grbl, "a comment that names Grbl"),
    ("Haas", Family::Haas, "a comment that names Haas"),
    ("Meldas", Family::Mitsubishi, "a comment that names Meldas"), // Mitsubishi is on tools, too
];

/// One line: its letters, without comments and blanks.
pub(crate) struct SplitLine {
    /// Capitals, without N and its number.
    pub(crate) code: String,
    /// Letter, number as written, place.
    pub(crate) words: Vec<(char, String, Span)>,
    /// What a semicolon divides: something before it, something behind it.
    pub(crate) divided: Option<(bool, bool)>,
    /// The first comment in brackets, up to its comma.
    pub(crate) keyword: String,
    /// It speaks of a control by its name.
    pub(crate) names: Option<&'static ControlName>,
    /// From its first to its last character that is no blank.
    pub(crate) span: Span,
}

impl SplitLine {
    pub(crate) fn read(text: &[u8], at: Span) -> Self {
        let text = text.get(..OF_A_LINE).unwrap_or(text);
        let blanks = text.len() - text.trim_ascii_start().len();
        let span = Span {
            start: at.start + blanks as u32,
            end: at.start + text.trim_ascii_end().len().max(blanks) as u32,
            ..at
        };
        let mut line = Self {
            code: String::new(),
            words: Vec::new(),
            divided: None,
            keyword: String::new(),
            names: NAMES.iter().find(|(name, ..)| {
                text.windows(name.len()).any(|word| word.eq_ignore_ascii_case(name.as_bytes()))
            }),
            span,
        };
        let (mut inside, mut comment, mut depth) = (false, String::new(), 0_u32);
        for (i, byte) in text.iter().enumerate() {
            let c = char::from(byte.to_ascii_uppercase());
            match c {
                '(' if !inside => inside = true,
                ')' if inside => {
                    inside = false;
                    if let Some((keyword, _)) =
                        comment.split_once(',').filter(|_| line.keyword.is_empty())
                    {
                        keyword.trim().clone_into(&mut line.keyword);
                    }
                    comment.clear();
                }
                _ if inside => comment.push(c),
                ';' => {
                    let behind = !text[i + 1..].trim_ascii().is_empty();
                    line.divided = Some((!line.code.is_empty(), behind));
                    break;
                }
                _ if c.is_ascii_whitespace() => {}
                _ => {
                    depth = match c {
                        '[' => depth + 1,
                        ']' => depth.saturating_sub(1),
                        _ => depth,
                    };
                    line.add(c, at.start + i as u32, depth);
                }
            }
        }
        let numbered = line
            .code
            .strip_prefix('N')
            .map(|rest| rest.trim_start_matches(|c: char| c.is_ascii_digit()).to_owned());
        if let Some(rest) = numbered.filter(|rest| rest.len() + 1 < line.code.len()) {
            line.code = rest;
            line.words.retain(|(letter, ..)| *letter != 'N');
        }
        line
    }

    /// One more character.
    fn add(&mut self, c: char, at: u32, depth: u32) {
        self.code.push(c);
        if depth > 0 {
            return;
        }
        if c.is_ascii_alphabetic() {
            let span = Span { start: at, end: at + 1, ..self.span };
            self.words.push((c, String::new(), span));
        } else if let Some((_, number, span)) = self.words.last_mut()
            && (c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | '#'))
            && span.end + 1 >= at
        {
            number.push(c);
            span.end = at + 1;
        }
    }

    pub(crate) fn has(&self, letters: &str) -> bool {
        letters.chars().all(|letter| {
            self.words.iter().any(|(c, number, _)| *c == letter && !number.is_empty())
        })
    }

    pub(crate) fn has_any(&self, letters: &str) -> bool {
        letters.chars().any(|letter| self.has(letter.encode_utf8(&mut [0; 4])))
    }

    pub(crate) fn number(&self, letter: char) -> Option<(&str, Span)> {
        let word = self.words.iter().find(|(c, ..)| *c == letter)?;
        Some((&word.1, word.2))
    }

    /// P has digits behind its point: it can be no milliseconds.
    pub(crate) fn waits_for_a_fraction(&self) -> bool {
        let value = self.number('P').and_then(|(number, _)| number.parse::<f64>().ok());
        value.is_some_and(|value| value.fract() != 0.0)
    }
}

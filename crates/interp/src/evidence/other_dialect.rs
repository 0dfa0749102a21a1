//! A program that was written for another dialect than the one it is read in: its own words give it away.
//!
//! ```text
//!   %
//!   O1000               a numbered program      2 ┐
//!   G65 P9100 A1.       a macro is called       4 ├─► Fanuc 6 > LinuxCNC 0: said before all that follows from it
//!   IF[#1GT5]GOTO20     a jump                  4 ┘
//! ```
//!
//! Each kind of word counts once, for the dialects that have it, by how little the others could mean by it: 1 is a hint,
//! 4 is a word that no other dialect has. The dialect at hand is questioned where another one has at least
//! [`DECISIVE`] and more than itself. Read are the letters alone, not what they do, and only the first lines: what a
//! program is written for is seen at its beginning.
//!
//! Source: the code lists of Fanuc's series 30i (machining centres, lathes), of LinuxCNC 2.9 and of Brother's CNC-B00; figures
//! 8 and 9 of JPH0622778B2 for Toyoda.
use crate::{
    dialect::{Dialect, rules::Family},
    setup::Setup,
};
use diag::{Diagnostic, Span};

/// Weight from which on a dialect is suspected.
const DECISIVE: u32 = 4;
/// Lines and bytes that are looked at.
pub(crate) const LINES: usize = 4000;
pub(crate) const BYTES: u32 = 1 << 18;
/// Bytes of a line that are looked at: a longer one tells nothing more, and is refused.
const OF_A_LINE: usize = 1 << 12;
/// Pieces of evidence that are named.
const NAMED: usize = 4;
/// Brother's U and E, which a machine's setting gives to all dialects.
const CHIP_REMOVAL: &str = "chip removal after every so many holes";
/// Keywords of O-words in LinuxCNC's language.
const O_KEYWORDS: [&str; 15] = [
    "SUB",
    "ENDSUB",
    "RETURN",
    "CALL",
    "IF",
    "ELSEIF",
    "ELSE",
    "ENDIF",
    "WHILE",
    "ENDWHILE",
    "DO",
    "REPEAT",
    "ENDREPEAT",
    "BREAK",
    "CONTINUE",
];

/// A control's name, whose it is, and what that is evidence of.
type ControlName = (&'static str, Family, &'static str);
const NAMES: [ControlName; 3] = [
    ("Grbl", Family::Grbl, "a comment that names Grbl"),
    ("Haas", Family::Haas, "a comment that names Haas"),
    ("Meldas", Family::Mitsubishi, "a comment that names Meldas"), // Mitsubishi is on tools, too
];

/// Haas' cycles need no R.
const WITHOUT_R: &str = "a cycle without R";

/// A word that gives a dialect away.
struct Evidence {
    of: Family,
    weight: u32,
    what: &'static str,
    /// As the program has it.
    written: String,
    span: Span,
}

impl Evidence {
    /// Whether a dialect has such words.
    fn belongs_to(&self, dialect: Dialect) -> bool {
        dialect.rules().evidence.contains(&self.of)
    }
}

/// The dialect that a program is written for, if that is plainly not the one it is read in.
pub fn looks_like(source: &[u8], read_in: Dialect) -> Option<Dialect> {
    heaviest(&gather(source), read_in)
}

fn heaviest(evidence: &[Evidence], own: Dialect) -> Option<Dialect> {
    let weight = |dialect: Dialect| -> u32 {
        evidence.iter().filter(|e| e.belongs_to(dialect)).map(|e| e.weight).sum()
    };
    let family = |dialect: Dialect| dialect.rules().evidence;
    // of two as likely, the one with the rarer words
    let others = Dialect::BY_RARITY.into_iter().filter(|other| family(*other) != family(own));
    // where nothing else tells it from the own one, it may as well be a mistake
    let tells = |e: &&Evidence, other| e.belongs_to(other) && !e.belongs_to(own);
    let is_told = |other| evidence.iter().any(|e| tells(&e, other) && e.what != WITHOUT_R);
    let mut best = (DECISIVE.max(weight(own) + 1) - 1, None);
    for other in others {
        if weight(other) > best.0 && is_told(other) {
            best = (weight(other), Some(other));
        }
    }
    best.1
}

/// The words by which a program tells that it is for this dialect, each with its line.
pub fn telling_words(source: &[u8], dialect: Dialect) -> String {
    placed(&speaking(&gather(source), dialect))
}

/// What speaks most for a dialect, in the order of the program.
fn speaking(evidence: &[Evidence], dialect: Dialect) -> Vec<&Evidence> {
    let mut speaks: Vec<_> = evidence.iter().filter(|e| e.belongs_to(dialect)).collect();
    speaks.sort_by_key(|e| core::cmp::Reverse(e.weight));
    speaks.truncate(NAMED);
    speaks.sort_by_key(|e| e.span.start);
    speaks
}

fn placed(speaks: &[&Evidence]) -> String {
    let named: Vec<_> =
        speaks.iter().map(|e| format!("{} in line {}", e.written, e.span.line)).collect();
    named.join(", ")
}

/// What a program looks like, if that is not the dialect it is read in; a warning, at the program's first line.
pub fn other_dialect(source: &[u8], setup: &Setup) -> Option<Diagnostic> {
    let (mut evidence, own) = (gather(source), setup.dialect);
    if setup.cycles.chip_removal.is_some() {
        evidence.retain(|e| e.what != CHIP_REMOVAL); // every dialect has the words there
    }
    let other = heaviest(&evidence, own)?;
    let speaks = speaking(&evidence, other);
    let end = source.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(source.len());
    let span = Span { file: 0, line: 1, start: 0, end: end as u32 };
    let text = format!(
        "this looks like a program for {}, and is read as one for {}: {}",
        other.rules().people,
        own.rules().people,
        placed(&speaks)
    );
    let help = format!(
        "read it with --dialect {name}, or set dialect = \"{name}\" under [control] of the machine's file; what \
         follows may be due to that alone",
        name = other.name()
    );
    let mut finding = Diagnostic::warning("I0909", span, text).with_help(help);
    for e in speaks {
        finding = finding.with_label(e.span, e.what);
    }
    Some(finding)
}

/// Each kind of evidence once.
fn gather(source: &[u8]) -> Vec<Evidence> {
    let mut all: Vec<Evidence> = Vec::new();
    let (mut start, mut first) = (0_u32, true);
    for (number, text) in source.split(|byte| *byte == b'\n').take(LINES).enumerate() {
        if start > BYTES {
            break;
        }
        let line = Line::read(text, Span { file: 0, line: number as u32 + 1, start, end: start });
        start += text.len() as u32 + 1;
        line.speaks(first, &mut |e| {
            if !all.iter().any(|known| known.what == e.what) {
                all.push(e);
            }
        });
        first &= line.code.is_empty() || line.code == "%" || line.code.starts_with('[');
    }
    all
}

/// One line: its letters, without comments and blanks.
pub(crate) struct Line {
    /// Capitals, without N and its number.
    pub(crate) code: String,
    /// Letter, number as written, place.
    pub(crate) words: Vec<(char, String, Span)>,
    /// What a semicolon divides: something before it, something behind it.
    divided: Option<(bool, bool)>,
    /// The first comment in brackets, up to its comma.
    keyword: String,
    /// It speaks of a control by its name.
    names: Option<&'static ControlName>,
    /// From its first to its last character that is no blank.
    span: Span,
}

impl Line {
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

    fn has_any(&self, letters: &str) -> bool {
        letters.chars().any(|letter| self.has(letter.encode_utf8(&mut [0; 4])))
    }

    pub(crate) fn number(&self, letter: char) -> Option<(&str, Span)> {
        let word = self.words.iter().find(|(c, ..)| *c == letter)?;
        Some((&word.1, word.2))
    }

    /// P has digits behind its point: it can be no milliseconds.
    fn waits_for_a_fraction(&self) -> bool {
        let value = self.number('P').and_then(|(number, _)| number.parse::<f64>().ok());
        value.is_some_and(|value| value.fract() != 0.0)
    }

    /// All that it gives away.
    fn speaks(&self, first: bool, tell: &mut impl FnMut(Evidence)) {
        self.form(first, tell);
        for (letter, number, span) in &self.words {
            let Ok(value) = number.parse::<f64>() else { continue };
            let code = ((value * 10.0).round() as i32, *letter);
            let mut say = |of, weight, what| {
                let written = format!("{letter}{number}");
                tell(Evidence { of, weight, what, written, span: *span });
            };
            match code {
                (tenths, 'G') => self.g(tenths, &mut say),
                (970, 'M') if self.has("P") => {
                    say(Family::Haas, 4, "a subprogram of this program is called by its block N");
                }
                (980, 'M') if self.has("PH") => {
                    say(Family::Mitsubishi, 4, "a subprogram is begun at a block, by H");
                }
                (1980, 'M') => say(Family::Fanuc, 3, "a program in another file is called"),
                (610, 'M') => say(Family::LinuxCnc, 3, "the tool's number is set"),
                (620..=680 | 700..=730, 'M') => {
                    say(Family::LinuxCnc, 2, "outputs, or modes that are kept");
                }
                (60, 'M') => say(Family::FanucMill, 1, "a tool is changed by M6"),
                (_, 'T') if number.len() == 4 && number.starts_with('0') && !self.has("M") => {
                    say(Family::FanucLathe, 2, "tool and offset in one number");
                }
                _ => {}
            }
        }
    }

    /// What the form of the line gives away.
    fn form(&self, first: bool, tell: &mut impl FnMut(Evidence)) {
        let code = self.code.as_str();
        if let Some(rest) = code.strip_prefix('$')
            && (rest.is_empty()
                || rest.starts_with(['$', 'H', 'X', 'I', 'N', 'G'])
                || rest.contains('='))
        {
            let (of, what, written) = (Family::Grbl, "a line for the controller", code.to_owned());
            tell(Evidence { of, weight: 5, what, written, span: self.span });
        }
        if let Some((name, of, what)) = self.names {
            let written = format!("\"{name}\"");
            tell(Evidence { of: *of, weight: 4, what, written, span: self.span });
        }
        let mut say = |of, weight, what, written: &str| {
            tell(Evidence { of, weight, what, written: written.to_owned(), span: self.span });
        };
        let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
        if let Some(rest) = code.strip_prefix('O') {
            let label = match rest.chars().next() {
                Some('<') => rest.find('>').map_or(0, |at| at + 1),
                Some('[') => rest.rfind(']').map_or(0, |_| rest.find(']').map_or(0, |at| at + 1)),
                _ => digits(rest),
            };
            let behind = &rest[label..];
            if label > 0 && behind.is_empty() && !rest.starts_with(['<', '[']) {
                let weight = if first { 2 } else { 1 };
                say(Family::Fanuc, weight, "a numbered program begins", code);
            }
            let keyword = behind.split('[').next().unwrap_or_default();
            if label > 0 && O_KEYWORDS.contains(&keyword) {
                say(Family::LinuxCnc, 5, "an O-word", &format!("O{} {keyword}", &rest[..label]));
            }
        }
        if let Some(rest) = code.strip_prefix("%O").filter(|rest| digits(rest) > 0) {
            let written = format!("%O{}", &rest[..digits(rest)]);
            say(Family::Fanuc, 4, "a numbered program beside the percent sign", &written);
        }
        if first
            && code.starts_with('[')
            && code[1..].starts_with(|c: char| c.is_ascii_alphabetic())
        {
            say(Family::Fanuc, 4, "a line for a simulator of Fanuc's controls", code);
        }
        if code.starts_with(':') && digits(&code[1..]) > 0 {
            say(Family::Fanuc, 4, "a numbered program begins, in the ISO way", code);
        }
        let jumps = ["IF[", "WHILE[", "GOTO"].into_iter().find(|word| code.starts_with(word));
        if let Some(word) = jumps {
            say(Family::Fanuc, 4, "a custom macro's jump or loop", word.trim_end_matches('['));
        }
        if ["DPRNT[", "BPRNT[", "POPEN", "PCLOS"].iter().any(|word| code.starts_with(word)) {
            say(
                Family::Fanuc,
                4,
                "a custom macro's output",
                code.split('[').next().unwrap_or(code),
            );
        }
        if code.contains("#3000=") || code.contains("#3006=") {
            say(Family::Fanuc, 3, "a custom macro's alarm or message", "#3000");
        }
        for corner in [",R", ",C"] {
            let number = code.split(corner).nth(1).and_then(|rest| rest.chars().next());
            if number.is_some_and(|c| c.is_ascii_digit() || matches!(c, '.' | '#' | '[')) {
                say(Family::Fanuc, 4, "a corner's chamfer or radius", corner);
            }
        }
        if code.contains("#9000") {
            say(Family::Mitsubishi, 3, "a common variable from #900000 on", "#900000");
        }
        if code.contains("#<") {
            say(Family::LinuxCnc, 3, "a parameter with a name", "#<…>");
        }
        if code.contains("**") {
            say(Family::LinuxCnc, 3, "a power", "**");
        }
        match self.divided {
            Some((false, true)) => say(Family::LinuxCnc, 2, "a comment behind a semicolon", ";"),
            Some((true, false)) => say(Family::Fanuc, 1, "a semicolon ends the block", ";"),
            _ => {}
        }
        if ["MSG", "DEBUG", "PRINT", "LOG", "LOGOPEN", "PROBEOPEN"].contains(&self.keyword.as_str())
        {
            say(
                Family::LinuxCnc,
                2,
                "a comment that does something",
                &format!("({},", self.keyword),
            );
        }
    }

    /// What a G code gives away, in tenths.
    fn g(&self, tenths: i32, say: &mut impl FnMut(Family, u32, &'static str)) {
        match tenths {
            650 | 660 | 661 if self.has("P") => say(Family::Fanuc, 4, "a custom macro is called"),
            510 if self.has_any("XYZIJK") => say(Family::FanucMill, 3, "scaling"),
            510 if self.has("P") => say(Family::Toyoda, 3, "a cam's profile is called"),
            530 if self.words.iter().filter(|(c, ..)| *c == 'G').count() == 2 && self.has("SP") => {
                say(Family::Toyoda, 4, "samples are taken in a spark-out");
            }
            40 if self.has("SP") => say(Family::Toyoda, 3, "a spark-out of so many turns"),
            511 if !self.has("P") => say(Family::FanucMill, 3, "a mirror image"),
            680 if self.has("R") => say(Family::FanucMill, 3, "the coordinates are turned"),
            160 if !self.has_any("XYZ") => say(Family::FanucMill, 3, "polar coordinates"),
            541 if self.has("P") => say(Family::FanucMill, 3, "a work offset beyond the sixth"),
            51 if self.has("Q") && !self.has_any("XYIJ") => {
                say(Family::Fanuc, 3, "look-ahead or smoothing");
            }
            440 if self.has("H") => say(Family::FanucMill, 3, "a tool length that is taken away"),
            430 if self.has("H") => say(Family::FanucMill, 1, "a tool length"),
            71 | 121 | 1070 | 1120 => say(Family::Fanuc, 2, "a path on a cylinder or a face"),
            500 if self.has("S") => say(Family::FanucLathe, 4, "the highest speed of the spindle"),
            320 if self.has_any("ZW") && self.has_any("FE") => {
                say(Family::FanucLathe, 4, "a thread");
            }
            700..=720
                if tenths % 10 == 0 && (self.has("PQ") || self.has_any("UW") && self.has("R")) =>
            {
                say(Family::FanucLathe, 4, "a multiple repetitive cycle");
            }
            760 if !self.has_any("XYZ")
                && self.has("PR")
                && self.number('P').is_some_and(|(p, _)| p.len() > 4 && !p.contains('.')) =>
            {
                say(Family::FanucLathe, 4, "a thread in passes");
            }
            280 if self.has_any("UW") => {
                say(Family::FanucLathe, 3, "the reference point by increments");
            }
            1510 if self.has("P") => say(Family::LinuxCnc, 6, "a cam's profile is called by G151"),
            1540 if self.has("P") && !self.has_any("SF") => {
                say(Family::Haas, 3, "a work offset beyond the sixth, by G154");
            }
            1870 if self.has_any("PE") => say(Family::Haas, 4, "how corners are taken, by G187"),
            1201 if self.has("PQ") => say(Family::Mitsubishi, 4, "how paths are worked, by G120.1"),
            1030 if self.has("P") => say(Family::Haas, 2, "how far the control looks ahead"),
            40 | 810..=830 if tenths % 10 == 0 && self.waits_for_a_fraction() => {
                say(Family::Haas, 1, "a wait in seconds, with a point");
            }
            810..=850 if tenths % 10 == 0 && self.has("Z") && !self.has_any("RUEK") => {
                say(Family::Haas, 1, WITHOUT_R);
            }
            120 | 130 if self.has("IKQ") => say(Family::Haas, 4, "a round pocket in rings"),
            120 | 130 if self.has("ID") => {
                say(Family::Haas, 3, "a round pocket");
                say(Family::Mitsubishi, 3, "a circle from its centre");
            }
            1000 if self.has("T") => say(Family::Brother, 6, "the non-stop tool change"),
            770 | 780 if self.has_any("IJ") && self.has_any("ZR") && self.has_any("SR") => {
                say(Family::Brother, 6, "synchronised tapping by its pitch");
            }
            740 | 810 | 820 | 840 if self.has("E") => {
                let weight = if self.has("U") { 5 } else { 4 };
                say(Family::Brother, weight, CHIP_REMOVAL);
            }
            331 | 382..=385 => say(Family::LinuxCnc, 4, "rigid tapping or probing"),
            52 | 53 => say(Family::LinuxCnc, 3, "a NURBS"),
            640 if self.has("P") => say(Family::LinuxCnc, 3, "a tolerance of the path"),
            611 | 591..=593 | 901 | 911 | 922 | 923 | 432 => {
                say(Family::LinuxCnc, 2, "a code with a point");
            }
            _ => {}
        }
    }
}

//! Edits that users make, each at some line of a program.
use interp::Dialect;

/// What becomes of a line and what follows it.
#[derive(Clone, Copy)]
pub(crate) enum Edit {
    /// Its last digit is another one.
    Digit,
    /// Written at its end.
    After(&'static str),
    /// Written at its beginning.
    Before(&'static str),
    /// Written before it, as lines.
    Lines(&'static str),
    /// Twenty lines from elsewhere.
    Paste,
    Removed,
}

/// Edits of every program.
const COMMON: &[(&str, Edit)] = &[
    ("a digit", Edit::Digit),
    ("a line more", Edit::Lines("X3.5\n")),
    ("a line less", Edit::Removed),
    ("a paste", Edit::Paste),
    ("half: (", Edit::After(" (no")),
    ("half: [", Edit::After(" [")),
    ("error", Edit::Lines("G999\n")),
    ("G91", Edit::Lines("G91\n")),
    ("tool", Edit::Lines("T2 M6\n")),
];
const OF_LINUXCNC: &[(&str, Edit)] = &[
    ("loop", Edit::Lines("o9 repeat [2]\nX1\no9 endrepeat\n")),
    ("half: loop", Edit::Lines("o9 repeat [2]\n")),
    ("half: o", Edit::Before("o")),
];
const OF_FANUC: &[(&str, Edit)] = &[
    ("N", Edit::Before("N5 ")),
    ("GOTO", Edit::Lines("GOTO 9999\n")),
    ("loop", Edit::Lines("WHILE [#120 LT 2] DO2\n#120=#120+1\nEND2\n")),
    ("half: loop", Edit::Lines("WHILE [#120 LT 2] DO2\n")),
    ("M98", Edit::Lines("M98 P8\n")),
    ("O", Edit::Lines("O2\n")),
];

/// Those of a dialect's programs.
pub(crate) fn of(dialect: Dialect) -> impl Iterator<Item = &'static (&'static str, Edit)> {
    COMMON.iter().chain(if dialect == Dialect::Fanuc { OF_FANUC } else { OF_LINUXCNC })
}

impl Edit {
    /// Lines that it takes away, from which line on (from 0), and the text in their place.
    pub(crate) fn at(self, lines: &[String], line: usize, repetition: usize) -> Change {
        let own = &lines[line];
        let ended = own.trim_end_matches('\n');
        let (line, taken, text) = match self {
            Self::Digit => {
                let digit = ended.rfind(|c: char| c.is_ascii_digit()).unwrap_or(0);
                let other = (ended.as_bytes()[digit] - b'0' + 1 + repetition as u8 % 8) % 10;
                (line, 1, format!("{}{other}{}", &ended[..digit], &own[digit + 1..]))
            }
            Self::After(text) => (line, 1, format!("{ended}{text}\n")),
            Self::Before(text) => (line, 1, format!("{text}{own}")),
            Self::Lines(text) => (line, 0, text.to_owned()),
            Self::Paste => (line, 0, lines[lines.len() / 3..][..20].concat()),
            Self::Removed => (line, 1, String::new()),
        };
        Change { line, taken: lines[line..line + taken].concat(), text }
    }
}

/// Whole lines in the place of others.
pub(crate) struct Change {
    pub(crate) line: usize,
    pub(crate) taken: String,
    pub(crate) text: String,
}

impl Change {
    /// The edit that takes this one back.
    pub(crate) fn undone(&self) -> Self {
        Self { line: self.line, taken: self.text.clone(), text: self.taken.clone() }
    }

    /// From where in its line to where in which one, and what comes there: no more than what
    /// changes.
    pub(crate) fn least(&self) -> ((u32, u32), (u32, u32), &str) {
        let same = self.taken.bytes().zip(self.text.bytes()).take_while(|(a, b)| a == b).count();
        let (taken, text) = (&self.taken[same..], &self.text[same..]);
        let tail = taken.bytes().rev().zip(text.bytes().rev()).take_while(|(a, b)| a == b).count();
        let (taken, text) = (&taken[..taken.len() - tail], &text[..text.len() - tail]);
        let place = |gone: &str| {
            let line = self.line + gone.matches('\n').count();
            let column = gone.len() - gone.rfind('\n').map_or(0, |at| at + 1);
            (line as u32, column as u32)
        };
        let to = &self.taken[..same + taken.len()];
        (place(&self.taken[..same]), place(to), text)
    }
}

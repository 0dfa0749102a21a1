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
    /// The first line of the program is another one.
    First(&'static str),
}

/// Edits of every program.
const COMMON: &[(&str, Edit)] = &[
    ("a digit", Edit::Digit),
    ("a line more", Edit::Lines("X3.5\n")),
    ("a line less", Edit::Removed),
    ("a paste", Edit::Paste),
    ("half: G", Edit::After(" G")),
    ("half: X", Edit::After(" X")),
    ("half: Q", Edit::After(" Q")),
    ("half: (", Edit::After(" (no")),
    ("half: [", Edit::After(" [")),
    ("error", Edit::Lines("G999\n")),
    ("G20", Edit::Lines("G20\n")),
    ("G91", Edit::Lines("G91\n")),
    ("G90", Edit::Lines("G90\n")),
    ("G41", Edit::Lines("G41 D1\n")),
    ("G42", Edit::Lines("G42 D1\n")),
    ("G18", Edit::Lines("G18\n")),
    ("G19", Edit::Lines("G19\n")),
    ("G49", Edit::Lines("G49\n")),
    ("G43", Edit::Lines("G43 H2\n")),
    ("G55", Edit::Lines("G55\n")),
    ("tool", Edit::Lines("T2 M6\n")),
    ("G93", Edit::Lines("G93\n")),
    ("G95", Edit::Lines("G95 F0.1\n")),
    ("F", Edit::Lines("F77\n")),
    ("F0", Edit::Lines("F0\n")),
    ("G94", Edit::Lines("G94\n")),
    ("S", Edit::Lines("S77\n")),
    ("M5", Edit::Lines("M5\n")),
    ("M8", Edit::Lines("M8\n")),
    ("G0", Edit::Lines("G0 X1\n")),
    ("G2", Edit::Lines("G2 X0 Y0 R500\n")),
    ("G80", Edit::Lines("G80\n")),
    ("G81", Edit::Lines("G81 X1 Y1 Z-3 R1\n")),
    ("G98", Edit::Lines("G98\n")),
    ("G92", Edit::Lines("G92 X7\n")),
    ("G52", Edit::Lines("G52 X7\n")),
    ("G10", Edit::Lines("G10 L2 P1 X3\n")),
    ("G64", Edit::Lines("G64 P0.1\n")),
    ("G28", Edit::Lines("G28\n")),
    ("#1", Edit::Lines("#1=5\n")),
    ("#5", Edit::Lines("#5=5\n")),
    ("M0", Edit::Lines("M0\n")),
    ("/", Edit::Before("/")),
    ("note", Edit::Before("(note) ")),
];
const OF_LINUXCNC: &[(&str, Edit)] = &[
    ("G10 R", Edit::Lines("G10 L2 P1 R30\n")),
    ("loop", Edit::Lines("o9 repeat [2]\nX1\no9 endrepeat\n")),
    ("half: loop", Edit::Lines("o9 repeat [2]\n")),
    ("half: o", Edit::Before("o")),
    ("G90.1", Edit::Lines("G90.1\n")),
    ("G7", Edit::Lines("G7\n")),
    ("M70", Edit::Lines("M70\n")),
    ("%", Edit::First("%\n")),
];
const OF_FANUC: &[(&str, Edit)] = &[
    ("G68", Edit::Lines("G68 X1. Y1. R30.\n")),
    ("G51", Edit::Lines("G51 X0 Y0 P2000\n")),
    ("G51.1", Edit::Lines("G51.1 X0\n")),
    ("G16", Edit::Lines("G16\n")),
    ("N", Edit::Before("N5 ")),
    ("#100", Edit::Lines("#100=5\n")),
    ("#500", Edit::Lines("#500=5.\n")),
    ("GOTO", Edit::Lines("GOTO 9999\n")),
    ("loop", Edit::Lines("WHILE [#120 LT 2] DO2\n#120=#120+1\nEND2\n")),
    ("half: loop", Edit::Lines("WHILE [#120 LT 2] DO2\n")),
    ("M98", Edit::Lines("M98 P8\n")),
    ("G66", Edit::Lines("G66 P7\n")),
    ("O", Edit::Lines("O2\n")),
    ("%", Edit::First("\n")),
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
            Self::First(text) => (0, 1, text.to_owned()),
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

    /// From where in its line to where in which one, and what comes there: no more than what changes.
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

//! The words and forms of a line that give a dialect away, and how much each of them says.
//!
//! They stand in one table, not with their dialects: a word tells by what the others do not mean by
//! it.
use crate::{
    dialect::{Dialect, rules::Family},
    evidence::line::SplitLine,
};
use diag::Span;

/// Brother's U and E, which a machine's setting gives to all dialects.
pub(crate) const CHIP_REMOVAL: &str = "chip removal after every so many holes";

/// Keywords of O-words in LinuxCNC's language.
pub(crate) const O_KEYWORDS: [&str; 15] = [
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

/// Haas' cycles need no R.
pub(crate) const WITHOUT_R: &str = "a cycle without R";

/// A word that gives a dialect away.
pub(crate) struct Evidence {
    pub(crate) of: Family,
    pub(crate) weight: u32,
    pub(crate) what: &'static str,
    /// As the program has it.
    pub(crate) written: String,
    pub(crate) span: Span,
}

impl Evidence {
    /// Whether a dialect has such words.
    pub(crate) fn belongs_to(&self, dialect: Dialect) -> bool {
        dialect.rules().evidence.contains(&self.of)
    }
}

/// All that it gives away.
pub(crate) fn speaks(line: &SplitLine, first: bool, tell: &mut impl FnMut(Evidence)) {
    form(line, first, tell);
    for (letter, number, span) in &line.words {
        let Ok(value) = number.parse::<f64>() else { continue };
        let code = ((value * 10.0).round() as i32, *letter);
        let mut say = |of, weight, what| {
            let written = format!("{letter}{number}");
            tell(Evidence { of, weight, what, written, span: *span });
        };
        match code {
            (tenths, 'G') => g(line, tenths, &mut say),
            (970, 'M') if line.has("P") => {
                say(Family::Haas, 4, "a subprogram of this program is called by its block N");
            }
            (980, 'M') if line.has("PH") => {
                say(Family::Mitsubishi, 4, "a subprogram is begun at a block, by H");
            }
            (1980, 'M') => say(Family::Fanuc, 3, "a program in another file is called"),
            (610, 'M') => say(Family::LinuxCnc, 3, "the tool's number is set"),
            (620..=680 | 700..=730, 'M') => {
                say(Family::LinuxCnc, 2, "outputs, or modes that are kept");
            }
            (60, 'M') => say(Family::FanucMill, 1, "a tool is changed by M6"),
            (_, 'T') if number.len() == 4 && number.starts_with('0') && !line.has("M") => {
                say(Family::FanucLathe, 2, "tool and offset in one number");
            }
            _ => {}
        }
    }
}

/// What the form of the line gives away.
fn form(line: &SplitLine, first: bool, tell: &mut impl FnMut(Evidence)) {
    let code = line.code.as_str();
    if let Some(rest) = code.strip_prefix('$')
        && (rest.is_empty()
            || rest.starts_with(['$', 'H', 'X', 'I', 'N', 'G'])
            || rest.contains('='))
    {
        let (of, what, written) = (Family::Grbl, "a line for the controller", code.to_owned());
        tell(Evidence { of, weight: 5, what, written, span: line.span });
    }
    if let Some((name, of, what)) = line.names {
        let written = format!("\"{name}\"");
        tell(Evidence { of: *of, weight: 4, what, written, span: line.span });
    }
    let mut say = |of, weight, what, written: &str| {
        tell(Evidence { of, weight, what, written: written.to_owned(), span: line.span });
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
    if first && code.starts_with('[') && code[1..].starts_with(|c: char| c.is_ascii_alphabetic()) {
        say(Family::Fanuc, 4, "a line for a simulator of Fanuc's controls", code);
        if code.starts_with("[BILLETX") && code.contains('Z') && !code.contains('Y') {
            say(Family::FanucLathe, 4, "a round blank: a diameter and a length", code);
        }
    }
    if code.starts_with(':') && digits(&code[1..]) > 0 {
        say(Family::Fanuc, 4, "a numbered program begins, in the ISO way", code);
    }
    let jumps = ["IF[", "WHILE[", "GOTO"].into_iter().find(|word| code.starts_with(word));
    if let Some(word) = jumps {
        say(Family::Fanuc, 4, "a custom macro's jump or loop", word.trim_end_matches('['));
    }
    if ["DPRNT[", "BPRNT[", "POPEN", "PCLOS"].iter().any(|word| code.starts_with(word)) {
        say(Family::Fanuc, 4, "a custom macro's output", code.split('[').next().unwrap_or(code));
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
    match line.divided {
        Some((false, true)) => say(Family::LinuxCnc, 2, "a comment behind a semicolon", ";"),
        Some((true, false)) => say(Family::Fanuc, 1, "a semicolon ends the block", ";"),
        _ => {}
    }
    if ["MSG", "DEBUG", "PRINT", "LOG", "LOGOPEN", "PROBEOPEN"].contains(&line.keyword.as_str()) {
        say(Family::LinuxCnc, 2, "a comment that does something", &format!("({},", line.keyword));
    }
}

/// What a G code gives away, in tenths.
fn g(line: &SplitLine, tenths: i32, say: &mut impl FnMut(Family, u32, &'static str)) {
    match tenths {
        650 | 660 | 661 if line.has("P") => say(Family::Fanuc, 4, "a custom macro is called"),
        510 if line.has_any("XYZIJK") => say(Family::FanucMill, 3, "scaling"),
        510 if line.has("P") => say(Family::Toyoda, 3, "a cam's profile is called"),
        530 if line.words.iter().filter(|(c, ..)| *c == 'G').count() == 2 && line.has("SP") => {
            say(Family::Toyoda, 4, "samples are taken in a spark-out");
        }
        40 if line.has("SP") => say(Family::Toyoda, 3, "a spark-out of so many turns"),
        511 if !line.has("P") => say(Family::FanucMill, 3, "a mirror image"),
        680 if line.has("R") => say(Family::FanucMill, 3, "the coordinates are turned"),
        160 if !line.has_any("XYZ") => say(Family::FanucMill, 3, "polar coordinates"),
        541 if line.has("P") => say(Family::FanucMill, 3, "a work offset beyond the sixth"),
        51 if line.has("Q") && !line.has_any("XYIJ") => {
            say(Family::Fanuc, 3, "look-ahead or smoothing");
        }
        440 if line.has("H") => say(Family::FanucMill, 3, "a tool length that is taken away"),
        430 if line.has("H") => say(Family::FanucMill, 1, "a tool length"),
        71 | 121 | 1070 | 1120 => say(Family::Fanuc, 2, "a path on a cylinder or a face"),
        500 if line.has("S") => say(Family::FanucLathe, 4, "the highest speed of the spindle"),
        320 if line.has_any("ZW") && line.has_any("FE") => {
            say(Family::FanucLathe, 4, "a thread");
        }
        700..=720
            if tenths % 10 == 0 && (line.has("PQ") || line.has_any("UW") && line.has("R")) =>
        {
            say(Family::FanucLathe, 4, "a multiple repetitive cycle");
        }
        760 if !line.has_any("XYZ")
            && line.has("PR")
            && line.number('P').is_some_and(|(p, _)| p.len() > 4 && !p.contains('.')) =>
        {
            say(Family::FanucLathe, 4, "a thread in passes");
        }
        280 if line.has_any("UW") => {
            say(Family::FanucLathe, 3, "the reference point by increments");
        }
        1510 if line.has("P") => say(Family::LinuxCnc, 6, "a cam's profile is called by G151"),
        1540 if line.has("P") && !line.has_any("SF") => {
            say(Family::Haas, 3, "a work offset beyond the sixth, by G154");
        }
        1870 if line.has_any("PE") => say(Family::Haas, 4, "how corners are taken, by G187"),
        1201 if line.has("PQ") => say(Family::Mitsubishi, 4, "how paths are worked, by G120.1"),
        1030 if line.has("P") => say(Family::Haas, 2, "how far the control looks ahead"),
        40 | 810..=830 if tenths % 10 == 0 && line.waits_for_a_fraction() => {
            say(Family::Haas, 1, "a wait in seconds, with a point");
        }
        810..=850 if tenths % 10 == 0 && line.has("Z") && !line.has_any("RUEK") => {
            say(Family::Haas, 1, WITHOUT_R);
        }
        120 | 130 if line.has("IKQ") => say(Family::Haas, 4, "a round pocket in rings"),
        120 | 130 if line.has("ID") => {
            say(Family::Haas, 3, "a round pocket");
            say(Family::Mitsubishi, 3, "a circle from its centre");
        }
        1000 if line.has("T") => say(Family::Brother, 6, "the non-stop tool change"),
        770 | 780 if line.has_any("IJ") && line.has_any("ZR") && line.has_any("SR") => {
            say(Family::Brother, 6, "synchronised tapping by its pitch");
        }
        740 | 810 | 820 | 840 if line.has("E") => {
            let weight = if line.has("U") { 5 } else { 4 };
            say(Family::Brother, weight, CHIP_REMOVAL);
        }
        331 => say(Family::LinuxCnc, 4, "rigid tapping"),
        382..=385 => say(Family::Probing, 4, "probing"),
        52 | 53 => say(Family::LinuxCnc, 3, "a NURBS"),
        640 if line.has("P") => say(Family::LinuxCnc, 3, "a tolerance of the path"),
        611 | 591..=593 | 901 | 911 | 922 | 923 | 432 => {
            say(Family::LinuxCnc, 2, "a code with a point");
        }
        _ => {}
    }
}

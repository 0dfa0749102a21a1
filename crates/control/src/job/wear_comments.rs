//! Comments that say that a program's way is that of the tool's centre: its offsets D hold wear
//! alone, and G41 and G42 lead the tool on the way.
//!
//! ```text
//!   (COMPENSATION TYPE: WEAR)   (WEAR COMP)   (REVERSE WEAR COMP)    of the program
//!   (COMPUTER COMPENSATION)     (TOOL CENTER PATH)                   of the program
//!   (ALL TOOL RAD=.0)                                                of the program
//!   (D8 WEAR)   (D08 = 0)   (T3 DIA = 0)   (T8 WEAR COMP)            of one offset
//! ```
//!
//! A program that speaks of compensation in the control too is not taken at a word that names no
//! offset: some of its ways are the part's edges.
use super::described::comments;
use interp::WearOffsets;

/// Bytes of a program that are looked at.
const MOST: usize = 1 << 22;

/// What a program's comments say of its offsets.
pub(super) fn wear_offsets(source: &[u8]) -> WearOffsets {
    let text = String::from_utf8_lossy(&source[..source.len().min(MOST)]);
    let mut found = WearOffsets::default();
    let mut is_mixed = false;
    for comment in comments(&text) {
        let words = words(comment);
        is_mixed |= is_in_control(&words);
        let number = number_of(&words);
        let said = || comment.trim().to_owned();
        match number {
            Some(number) if is_wear(&words) || is_zero(&words) => {
                found.of.entry(number).or_insert_with(said);
            }
            None if is_of_all(&words) => _ = found.all.get_or_insert_with(said),
            _ => {}
        }
    }
    if is_mixed {
        found.all = None;
    }
    found
}

/// Upper-case words; `D8=0` is three of them.
fn words(comment: &str) -> Vec<String> {
    let spaced: String = comment
        .chars()
        .map(|c| match c {
            '=' => " = ".to_owned(),
            ':' | ',' | ';' | '|' | '[' | ']' | '(' | ')' | '-' | '/' => " ".to_owned(),
            c => c.to_ascii_uppercase().to_string(),
        })
        .collect();
    spaced.split_whitespace().map(str::to_owned).collect()
}

fn follow(words: &[String], first: &[&str], second: &[&str]) -> bool {
    let is_one = |word: &String, of: &[&str]| of.contains(&word.trim_end_matches('.'));
    words.windows(2).any(|pair| is_one(&pair[0], first) && is_one(&pair[1], second))
}

const COMPENSATION: [&str; 3] = ["COMP", "COMPENSATION", "COMPENSATED"];

/// The way is that of the tool's centre; not: no wear.
fn is_wear(words: &[String]) -> bool {
    let denied = follow(words, &["NO", "NOT", "WITHOUT"], &["WEAR", "COMPUTER"]);
    let plain: Vec<String> = words.iter().filter(|word| *word != "=").cloned().collect();
    let typed = follow(&plain, &["TYPE", "COMP", "COMPENSATION"], &["WEAR", "COMPUTER"]);
    let named = follow(words, &["WEAR", "COMPUTER"], &COMPENSATION);
    let of_offset = words
        .windows(2)
        .any(|pair| numbered(&pair[0], 'D').is_some() && matches!(pair[1].as_str(), "WEAR" | "="))
        && words.iter().any(|word| word == "WEAR");
    !denied && (typed || named || of_offset)
}

/// The program says it of every offset.
fn is_of_all(words: &[String]) -> bool {
    let centre = ["CENTER", "CENTRE", "CENTERLINE", "CENTRELINE"];
    let path = ["PATH", "PROGRAM", "PROGRAMMED", "PROGRAMMING"];
    let is_path = follow(words, &["TOOL", "CUTTER"], &centre) && follow(words, &centre, &path);
    let all_tools = follow(words, &["ALL"], &["TOOL", "TOOLS"]) && is_zero(words);
    is_wear(words) || is_path || all_tools
}

/// Compensation by the radius, in the control.
fn is_in_control(words: &[String]) -> bool {
    follow(words, &["CONTROL"], &COMPENSATION)
        || follow(words, &["TYPE", "COMP", "COMPENSATION"], &["CONTROL"])
}

/// A radius, a diameter, or an offset that is 0.
fn is_zero(words: &[String]) -> bool {
    let is_key = |word: &String| {
        matches!(word.trim_end_matches('.'), "RAD" | "RADIUS" | "DIA" | "DIAM" | "DIAMETER")
            || numbered(word, 'D').is_some()
    };
    let is_nought = |word: &String| word.parse::<f64>().is_ok_and(|value| value == 0.0);
    words.windows(3).any(|three| is_key(&three[0]) && three[1] == "=" && is_nought(&three[2]))
}

/// `D8`, `T3`, `TOOL 3`.
fn number_of(words: &[String]) -> Option<u32> {
    let offset = words.iter().find_map(|word| numbered(word, 'D'));
    let tool = || {
        let first = words.first()?;
        let next = words.get(1).filter(|_| first == "TOOL").and_then(|word| word.parse().ok());
        numbered(first, 'T').or(next)
    };
    offset.or_else(tool)
}

fn numbered(word: &str, letter: char) -> Option<u32> {
    let digits = word.strip_prefix(letter)?;
    digits.parse().ok().filter(|number| *number > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comment_says_whose_offset_holds_wear_alone() {
        for (text, numbers) in [
            ("(D8 WEAR)", &[8][..]),
            ("(D08 = 0)", &[8]),
            ("(D8=0.)", &[8]),
            ("( T3 DIA = 0)", &[3]),
            ("(TOOL 3 RAD = .0)", &[3]),
            ("(T8 1/2 ENDMILL - WEAR COMP)", &[8]),
            ("(T8 D=12. CR=0. - flat end mill)", &[]),
            ("(T8 D=12. - ZMIN=0.)", &[]),
            ("(CHECK WEAR OF T8)", &[]),
            ("(T8 - NO WEAR COMP)", &[]),
            ("(D8 IS THE RADIUS)", &[]),
            ("(T3 DIA = 0.5)", &[]),
            ("(WEAR PLATE 12 MM)", &[]),
        ] {
            let found = wear_offsets(text.as_bytes());
            assert_eq!(found.of.keys().copied().collect::<Vec<_>>(), numbers, "{text}");
            assert_eq!(found.all, None, "{text}");
        }
    }

    #[test]
    fn a_comment_says_it_of_every_offset() {
        for (text, all) in [
            ("(COMPENSATION TYPE: WEAR)", true),
            ("(CUTTER COMP TYPE = WEAR)", true),
            ("(WEAR COMP)", true),
            ("(REVERSE WEAR COMPENSATION)", true),
            ("(COMPUTER COMPENSATION)", true),
            ("(TOOL CENTER PATH)", true),
            ("(CUTTER CENTERLINE PROGRAMMED)", true),
            ("(ALL TOOL RAD=.0)", true),
            ("(COMPENSATION TYPE: CONTROL)", false),
            ("(STEP BLOCK [CUTTER COMP])", false),
            ("(NO WEAR COMP)", false),
            ("(X0 Y0 CENTER OF PART)", false),
            ("(WEAR COMP)\n(CONTOUR 2: CONTROL COMP)", false),
        ] {
            assert_eq!(wear_offsets(text.as_bytes()).all.is_some(), all, "{text}");
        }
    }
}

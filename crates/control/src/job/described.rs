//! Tools that a program's comments name, as CAM posts write them: what stands in for tools that the
//! table lacks.
//!
//! ```text
//!   (T3  D=6. CR=0. - ZMIN=-12. - flat end mill)    Fusion 360, HSMWorks
//!   (T1 | 1/2 FLAT ENDMILL | H1)                    Mastercam
//!   (TOOL -1- MILL DIA 6.0 R0. MM)                  SolidCAM
//!   (TOOL - 4 1/4-20 TAP)  (T12 5.MM DRILL)         by hand
//! ```
//!
//! A number comes first, then what the table's own comments may say; a diameter behind `D`, `DIA`
//! or as a fraction is in the program's unit.
use canon::{Tool, ToolKind};
use units::Length;

/// Bytes of a program that are looked at: tools stand at its beginning, or where they are called.
const MOST: usize = 1 << 22;

/// The tools that a program names, each once.
pub(super) fn tools(source: &[u8]) -> Vec<Tool> {
    let text = String::from_utf8_lossy(&source[..source.len().min(MOST)]);
    let unit = unit_of(&text);
    let mut found: Vec<Tool> = Vec::new();
    for comment in comments(&text) {
        let Some(tool) = named(comment, unit) else { continue };
        match found.iter_mut().find(|known| known.number == tool.number) {
            None => found.push(tool),
            // the list at the head of a program, and the line before the call: the one that says
            // more
            Some(known) if known.kind == ToolKind::Other && tool.kind != ToolKind::Other => {
                *known = tool;
            }
            Some(_) => {}
        }
    }
    found
}

/// mm in a unit of the program: what it says first.
pub(super) fn unit_of(text: &str) -> f64 {
    let text = text.as_bytes();
    let says = |at: usize| match text.get(at + 1..) {
        // G20.1 and G200 are other codes
        Some([b'2', _, next, ..]) if next.is_ascii_digit() || *next == b'.' => None,
        Some([b'2', b'0', ..]) => Some(units::MM_PER_INCH),
        Some([b'2', b'1', ..]) => Some(1.0),
        _ => None,
    };
    memchr::memchr2_iter(b'G', b'g', text).find_map(says).unwrap_or(1.0)
}

/// What stands in brackets, and behind a semicolon; of a line, the brackets first.
pub(super) fn comments(text: &str) -> impl Iterator<Item = &str> {
    lines_with_comments(text).flat_map(|line| {
        let behind = line.split_once(';').map(|(_, comment)| comment);
        let inside = line.split('(').skip(1).map(|rest| rest.split(')').next().unwrap_or(rest));
        inside.chain(behind)
    })
}

/// Of a long program, few.
fn lines_with_comments(text: &str) -> impl Iterator<Item = &str> {
    let mut read = 0;
    std::iter::from_fn(move || {
        let sign = read + memchr::memchr2(b'(', b';', &text.as_bytes()[read..])?;
        let begin = text[read..sign].rfind('\n').map_or(read, |end| read + end + 1);
        let end = text[sign..].find('\n').map_or(text.len(), |end| sign + end);
        read = end;
        let line = &text[begin..end];
        Some(line.strip_suffix('\r').unwrap_or(line))
    })
}

fn named(comment: &str, unit: f64) -> Option<Tool> {
    let upper = comment.to_ascii_uppercase();
    let (number, rest) = number_and_rest(upper.trim_start())?;
    let rest = rest.trim_matches(|c: char| c.is_whitespace() || "-|:,=".contains(c));
    if rest.is_empty() {
        return None;
    }
    let words = words(rest);
    let known = store::tools::named(&words.join(" "));
    let kind = match known.kind {
        ToolKind::Other | ToolKind::EndMill(_) if is_mill(&words) => {
            ToolKind::EndMill(store::tools::mill_of_words(&words, unit))
        }
        kind => kind,
    };
    let stated = diameter(&words, unit).map(Length::mm);
    let diameter = match kind {
        ToolKind::Tap(_) => known.diameter,
        _ => stated.or(known.diameter),
    };
    if kind == ToolKind::Other && diameter.is_none() {
        return None;
    }
    Some(Tool {
        number,
        pocket: number,
        length: Length::ZERO,
        diameter: diameter.unwrap_or(Length::ZERO),
        kind,
        description: comment.trim().to_owned(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: true,
    })
}

/// `T3 …`, `TOOL 3 …`, `TOOL -3- …`, `TOOL #3 …`.
fn number_and_rest(text: &str) -> Option<(u32, &str)> {
    let rest = text.strip_prefix("TOOL").or_else(|| text.strip_prefix('T'))?;
    let rest = rest.trim_start_matches(|c: char| c.is_whitespace() || "-#:=.".contains(c));
    let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let number = rest[..digits].parse().ok().filter(|number| (1..10_000).contains(number))?;
    let rest = &rest[digits..];
    // `T6MM DRILL` is no tool 6
    (!rest.starts_with(|c: char| c.is_alphanumeric())).then_some((number, rest))
}

/// Words as the table's comments have them: `D=6.` and `5.MM` in two, `ENDMILL` in one.
fn words(text: &str) -> Vec<String> {
    let mut spaced = String::new();
    let mut before = ' ';
    for c in text.chars() {
        let is_number = before.is_ascii_digit() || before == '.';
        if is_number && matches!(c, 'M' | 'I') {
            spaced.push(' ');
        }
        match c {
            '"' => spaced.push_str(" inch "),
            '=' | '|' | ',' | '_' => spaced.push(' '),
            c => spaced.push(c),
        }
        before = c;
    }
    spaced
        .split_whitespace()
        .map(|word| word.trim_matches('-').to_ascii_lowercase())
        .filter(|word| !word.is_empty())
        .collect()
}

fn is_mill(words: &[String]) -> bool {
    const MILLS: [&str; 13] = [
        "mill", "endmill", "end-mill", "facemill", "ballmill", "ball", "bull", "bullnose", "flat",
        "chamfer", "face", "router", "fresa",
    ];
    words.iter().any(|word| MILLS.contains(&word.as_str()))
        && !words.iter().any(|word| matches!(word.as_str(), "drill" | "tap"))
}

/// mm: behind `d`, `dia`, `dia.`, `diameter`; else a number with its unit; else a fraction, or a
/// number in the first place.
fn diameter(words: &[String], unit: f64) -> Option<f64> {
    let number = |word: &str| {
        let plain = word.trim_end_matches('.');
        match plain.split_once('/') {
            Some((over, under)) => Some(over.parse::<f64>().ok()? / under.parse::<f64>().ok()?),
            None => plain.parse().ok(),
        }
        .filter(|value: &f64| value.is_finite() && *value > 0.0 && *value < 1000.0)
    };
    let unit_at = |at: usize| match words.get(at).map_or("", String::as_str) {
        "inch" | "in" => Some(25.4),
        "mm" => Some(1.0),
        _ => None,
    };
    let at = |at: usize| Some(number(words.get(at)?)? * unit_at(at + 1).unwrap_or(unit));
    let is_key =
        |word: &String| matches!(word.trim_end_matches(['.', ':']), "d" | "dia" | "diameter");
    let behind = || at(words.iter().position(is_key)? + 1);
    let joined = || words.iter().find_map(|word| Some(number(word.strip_prefix('d')?)? * unit));
    let united = || {
        (0..words.len())
            .find(|i| unit_at(i + 1).is_some() && number(&words[*i]).is_some())
            .and_then(at)
    };
    let fraction =
        || words.iter().position(|word| word.contains('/') && number(word).is_some()).and_then(at);
    let first = || words.first().filter(|word| word.contains('.')).and_then(|_| at(0));
    behind().or_else(joined).or_else(united).or_else(fraction).or_else(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::{Mill, MillForm};

    fn one(text: &str) -> (u32, ToolKind, f64) {
        let all = tools(text.as_bytes());
        assert_eq!(all.len(), 1, "{text}: {all:?}");
        (all[0].number, all[0].kind.clone(), all[0].diameter.value())
    }

    #[test]
    fn posts_name_their_tools() {
        let flat = Some(MillForm::FLAT);
        let mill = |form, teeth| ToolKind::EndMill(Mill { form, teeth, ..Mill::default() });
        assert_eq!(one("(T3  D=6. CR=0. - ZMIN=-12. - flat end mill)"), (3, mill(flat, None), 6.0));
        assert_eq!(one("G20\n(T1 | 1/2 FLAT ENDMILL | H1)"), (1, mill(flat, None), 12.7));
        assert_eq!(one("(TOOL -1- MILL DIA 6.0 R0. MM)"), (1, mill(None, None), 6.0));
        assert_eq!(one("(T4 - .5\" 5FL GARR ENDMILL)"), (4, mill(flat, Some(5)), 12.7));
        assert_eq!(one("(T212 |    3. FLAT ENDMILL | H0)"), (212, mill(flat, None), 3.0));
        assert_eq!(one("(TOOL 4 = 1IN FACE MILL)"), (4, mill(flat, None), 25.4));
        assert_eq!(one("(T3 1/8\" 3FLUTE .188LOC FLAT ENDMILL)"), (3, mill(flat, Some(3)), 3.175));
        assert_eq!(one("; T2 D=8 - ball end mill"), (2, mill(Some(MillForm::Ball), None), 8.0));
        let (number, kind, diameter) = one("(T12 5.MM DRILL)");
        assert_eq!((number, matches!(kind, ToolKind::Drill { .. }), diameter), (12, true, 5.0));
        let (number, kind, diameter) = one("(TOOL - 4 M6 TAP)");
        assert_eq!((number, matches!(kind, ToolKind::Tap(_)), diameter), (4, true, 6.0));
    }

    #[test]
    fn what_names_no_tool_is_none() {
        for text in
            ["(T6MM DRILL)", "(TOOL CHANGE)", "(T0101)", "(TIGHTEN THE VICE 3)", "(T3)", "(T3 H3)"]
        {
            assert!(tools(text.as_bytes()).is_empty(), "{text}");
        }
    }

    #[test]
    fn the_first_of_g20_and_g21_is_the_unit_of_a_program() {
        for (text, mm) in [
            ("", 1.0),
            ("G20", 25.4),
            ("g21\nG20", 1.0),
            ("G90 g20 G21", 25.4),
            ("G20.1 G200 G2 X1\nG21\nG20", 1.0),
            ("G2", 1.0),
        ] {
            assert_eq!(unit_of(text), mm, "{text:?}");
        }
    }

    #[test]
    fn any_text_is_read_to_its_end() {
        let mut random = 7_u64;
        let pieces = [
            "(", ")", "T", "TOOL", "3", "D=", "1/0", "\"", "MM", "ü", ";", "\n", "\r\n", "-", ".",
            "G20", " ",
        ];
        for _ in 0..2000 {
            let mut text = String::new();
            for _ in 0..12 {
                random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                text.push_str(pieces[(random >> 33) as usize % pieces.len()]);
            }
            for tool in tools(text.as_bytes()) {
                assert!(tool.number > 0 && tool.diameter.value().is_finite(), "{text}");
            }
            let line_by_line = text.lines().flat_map(comments);
            assert!(comments(&text).eq(line_by_line), "{text:?}");
        }
    }
}

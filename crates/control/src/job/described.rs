//! Tools that a program's comments name, as CAM posts write them: what stands in for tools that the
//! table lacks.
//!
//! ```text
//!   (T3  D=6. CR=0. - ZMIN=-12. - flat end mill)    Fusion 360, HSMWorks
//!   (T1 | 1/2 FLAT ENDMILL | H1)                    Mastercam
//!   (TOOL -1- MILL DIA 6.0 R0. MM)                  SolidCAM
//!   (Tool 2: End Mill {6 mm})                       Vectric
//!   (TC: 6mm Endmill) above M6 T2                   FreeCAD
//!   (TOOL - 1 DIA. OFF. - 21 LEN. - 1 DIA. - 10.)   Mastercam, by number alone
//!   (TOOL - 4 1/4-20 TAP)  (T12 5.MM DRILL)         by hand
//!   (T5 #7 DRILL)  (T6 LETTER F DRILL)              drills of the inch series
//!   (1/2 END MILL; T02)   (TOOLS: T04 1/2 ENDMILL)  by hand, the number last, or behind a word
//!   M6 T2 (ID=002 - DIA 0.5)                        beside the call
//! ```
//!
//! A number comes first, then what the table's own comments may say; a diameter behind `D`, `DIA`
//! or as a fraction is in the program's unit. The sizes of the inch series are in
//! [`drill_size`](super::drill_size).
use super::drill_size;
use canon::{Tool, ToolKind};
use units::Length;

/// Bytes of a program that are looked at: tools stand at its beginning, or where they are called.
const MOST: usize = 1 << 22;

/// The tools that a program names, each once.
pub(super) fn tools(source: &[u8]) -> Vec<Tool> {
    let text = String::from_utf8_lossy(&source[..source.len().min(MOST)]);
    let unit = unit_of(&text);
    let mut found: Vec<Tool> = Vec::new();
    let called_below = called_below(&text);
    for comment in comments(&text) {
        let tool = named(comment, unit)
            .or_else(|| numbered_last(comment, unit))
            .or_else(|| called_below(comment, unit))
            .or_else(|| called_beside(&text, comment, unit));
        let Some(tool) = tool else { continue };
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

/// Reads `FreeCAD`'s comments, which name a tool without its number: the number stands in the call
/// below.
fn called_below(text: &str) -> impl Fn(&str, f64) -> Option<Tool> {
    const LINES_BELOW: usize = 6;
    move |comment, unit| {
        let upper = comment.trim().to_ascii_uppercase();
        let name = upper.strip_prefix("TC:").or_else(|| upper.strip_prefix("TOOL:"))?;
        let at = comment.as_ptr() as usize - text.as_ptr() as usize;
        let below = text.get(at..)?.lines().skip(1).take(LINES_BELOW);
        let call = below
            .map(str::to_ascii_uppercase)
            .find(|line| line.split_whitespace().any(|word| matches!(word, "M6" | "M06")))?;
        let number = call.split_whitespace().find_map(|word| word.strip_prefix('T'))?;
        named(&format!("T{number} {name}"), unit)
    }
}

/// Reads a comment whose number comes last: `1/2 END MILL; T02`.
fn numbered_last(comment: &str, unit: f64) -> Option<Tool> {
    let upper = comment.trim().to_ascii_uppercase();
    let (name, last) = upper.rsplit_once('T')?;
    let is_apart = name.trim_end().ends_with([';', ',', '-', '|', '=', ':']);
    let number: u32 = last.parse().ok().filter(|_| is_apart)?;
    let tool = named(&format!("T{number} {}", name.trim_end()), unit)?;
    Some(Tool { description: comment.trim().to_owned(), ..tool })
}

/// Reads a comment in the block that calls the tool.
fn called_beside(text: &str, comment: &str, unit: f64) -> Option<Tool> {
    let at = comment.as_ptr() as usize - text.as_ptr() as usize;
    let line = text.get(..at)?.rsplit('\n').next()?;
    let block = line.split(['(', ';']).next()?.to_ascii_uppercase();
    let is_call = block.split_whitespace().any(|word| matches!(word, "M6" | "M06"));
    let mut numbers = block.split_whitespace().filter_map(|word| word.strip_prefix('T'));
    let number: u32 = numbers.next()?.parse().ok().filter(|number| *number > 0 && is_call)?;
    let tool = named(&format!("T{number} {comment}"), unit)?;
    Some(Tool { description: comment.trim().to_owned(), ..tool })
}

/// The unit that a program says first.
pub(super) fn unit(source: &[u8]) -> canon::LengthUnit {
    let text = String::from_utf8_lossy(&source[..source.len().min(MOST)]);
    if unit_of(&text) == 1.0 { canon::LengthUnit::Millimetre } else { canon::LengthUnit::Inch }
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
        inside(line).chain(behind)
    })
}

/// What stands in brackets; a bracket within a comment is a part of it.
fn inside(line: &str) -> impl Iterator<Item = &str> {
    let mut rest = line;
    std::iter::from_fn(move || {
        let (_, behind) = rest.split_once('(')?;
        let mut depth = 1_u32;
        let end = behind.char_indices().find(|(_, c)| {
            depth = match c {
                '(' => depth + 1,
                ')' => depth - 1,
                _ => depth,
            };
            depth == 0
        });
        let end = end.map_or(behind.len(), |(at, _)| at);
        rest = behind.get(end + 1..).unwrap_or_default();
        Some(&behind[..end])
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
    // a tap that names no thread: of its diameter nothing else is known
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
    let listed = text.strip_prefix("TOOLS").or_else(|| text.strip_prefix("TOOL"));
    let listed = listed.map(|rest| rest.trim_start_matches([':', ' ']));
    let text = listed.filter(|rest| rest.starts_with('T')).unwrap_or(text);
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
            '=' | '|' | ',' | '_' | '{' | '}' | '[' | ']' | '(' | ')' | ':' => spaced.push(' '),
            'Ø' | 'ø' | '⌀' | 'Φ' | 'φ' => spaced.push_str(" dia "),
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

/// mm: behind `d`, `dia`, `diameter`; else a number with its unit; else a fraction, a number in the
/// first place, or a size of the inch series.
fn diameter(words: &[String], unit: f64) -> Option<f64> {
    let unit_at = |at: usize| match words.get(at).map_or("", |word| word.trim_end_matches('.')) {
        "inch" | "in" | "inches" | "zoll" => Some(units::MM_PER_INCH),
        "mm" => Some(1.0),
        _ => None,
    };
    // a number, which a fraction may follow: 1 1/4
    let at = |at: usize| {
        let first = number(words.get(at)?)?;
        let is_whole = first.fract() == 0.0 && !words[at].contains(['.', '/']);
        let more = words.get(at + 1).filter(|word| is_whole && word.contains('/'));
        let more = more.and_then(|word| number(word)).filter(|part| *part < 1.0);
        let behind = at + 1 + usize::from(more.is_some());
        Some((first + more.unwrap_or(0.0)) * unit_at(behind).unwrap_or(unit))
    };
    let keyed = |keys: &[&str]| {
        let is_key = |word: &String| keys.contains(&word.trim_end_matches('.'));
        (0..words.len()).filter(|i| is_key(&words[*i])).find_map(|i| at(i + 1))
    };
    // `D1` and `DIA OFF 21` beside `H1` are numbers of offsets
    let has_offsets = words.iter().any(|word| is_numbered(word, 'h'));
    let behind = || keyed(&["dia", "diam", "diameter", "ø"]).or_else(|| keyed(&["d"]));
    let joined = || {
        (0..words.len()).find_map(|i| {
            let word = &words[i];
            let rest = ["diam", "dia", "d"].iter().find_map(|key| word.strip_prefix(key))?;
            let rest = rest.trim_start_matches('-');
            let size = number(rest).filter(|_| !has_offsets || rest.contains('.'))?;
            Some(size * unit_at(i + 1).unwrap_or(unit))
        })
    };
    let united = || {
        let has_unit = |i: &usize| {
            let is_mixed = words.get(i + 1).is_some_and(|word| word.contains('/'));
            number(&words[*i]).is_some() && unit_at(i + 1 + usize::from(is_mixed)).is_some()
        };
        (0..words.len()).find(has_unit).and_then(at)
    };
    let fraction = || {
        let i = words.iter().position(|word| word.contains('/') && number(word).is_some())?;
        let is_mixed = i > 0 && number(&words[i - 1]).is_some_and(|whole| whole.fract() == 0.0);
        if is_mixed && !words[i - 1].contains(['.', '/', '-']) { at(i - 1) } else { at(i) }
    };
    let first = || words.first().filter(|word| word.contains('.')).and_then(|_| at(0));
    let series = || drill_size::of_words(words).map(|inches| inches * units::MM_PER_INCH);
    behind().or_else(united).or_else(fraction).or_else(first).or_else(joined).or_else(series)
}

/// A number above zero: `6.`, `.25`, `1/4`, `1-1/4`.
fn number(word: &str) -> Option<f64> {
    let plain = word.trim_end_matches('.');
    let value = match plain.split_once('/') {
        Some((over, under)) => {
            let (whole, over) = over.split_once('-').unwrap_or(("0", over));
            let part = over.parse::<f64>().ok()? / under.parse::<f64>().ok()?;
            whole.parse::<f64>().ok()? + part
        }
        None => plain.parse().ok()?,
    };
    (value.is_finite() && value > 0.0 && value < 1000.0).then_some(value)
}

/// Whether a word is a letter with a whole number.
fn is_numbered(word: &str, letter: char) -> bool {
    let digits = word.strip_prefix(letter).unwrap_or_default();
    !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
}

/// Whether a tool of a table may be the one that a comment describes.
pub(super) fn is_same(known: &Tool, described: &Tool) -> bool {
    /// Difference of two diameters of one tool, mm.
    const SAME: f64 = 0.02;
    let is_close = described.diameter.value() <= 0.0
        || (known.diameter - described.diameter).value().abs() <= SAME;
    let of_kind = std::mem::discriminant(&known.kind) == std::mem::discriminant(&described.kind);
    (of_kind || described.kind == ToolKind::Other) && is_close
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
        for (text, mm) in DIAMETERS {
            let (_, _, diameter) = one(text);
            assert!((diameter - mm).abs() < 1e-3, "{text}: {diameter}, expected {mm}");
        }
        let (number, kind, diameter) = one("(TOOL - 4 M6 TAP)");
        assert_eq!((number, matches!(kind, ToolKind::Tap(_)), diameter), (4, true, 6.0));
    }

    /// As posts and people write a diameter, and what it is in mm.
    const DIAMETERS: [(&str, f64); 40] = [
        ("G20\n(1/2\" END MILL W/3 FLUTES; T02)", 12.7),
        ("(10 MM END MILL - T7)", 10.0),
        ("G20\n(Tools: T04 1/2\" Endmill, Square, 3 Flute, 1.75\" LOC)", 12.7),
        ("G20\n(T02 ID=002  DIA-0.5000  TOOL END MILL)", 12.7),
        ("G20\nM6 T02 (ID=002 - DIA 0.5)", 12.7),
        ("G20\nM06 T4 (1/2\" Endmill);", 12.7),
        ("(T5 #7 DRILL)", 5.1054),
        ("G20\n(T5 #7 DRILL)", 5.1054),
        ("(T5 NO. 43 DRILL)", 2.2606),
        ("(TOOL 5 NUMBER 60 DRILL)", 1.016),
        ("(T5 #7 (.201) DRILL)", 5.1054),
        ("(T6 LETTER F DRILL)", 6.5278),
        ("(T6 LTR Q DRILL)", 8.4328),
        ("(T6 F DRILL)", 6.5278),
        ("(T6 - 17/64 DRILL)\nG20", 6.7469),
        ("G20\n(T6 1-1/4 FACE MILL)", 31.75),
        ("G20\n(T6 1 1/2 FACE MILL)", 38.1),
        ("(T6 1 1/2 IN FACE MILL)", 38.1),
        ("(T3 3/8\" BALL ENDMILL)", 9.525),
        ("G20\n(T2 .25 ENDMILL)", 6.35),
        ("G20\n(T1  D=0.5 CR=0. - ZMIN=-0.25 - flat end mill)", 12.7),
        ("(T7  D=6.8 CR=0. TAPER=118deg - ZMIN=-20. - drill)", 6.8),
        ("(T4 D6.8 DRILL)", 6.8),
        ("(T4 DIA6.8 DRILL)", 6.8),
        ("(T4 DIAM. 6.8 DRILL)", 6.8),
        ("(T4 Ø6.8 DRILL)", 6.8),
        ("(T4 DIAMETER: 6.8 DRILL)", 6.8),
        ("(TOOL - 1 DIA. OFF. - 21 LEN. - 1 DIA. - 10.)", 10.0),
        ("(T212 | 3. FLAT ENDMILL | H1 | D1)", 3.0),
        ("(T1 | 1/2 FLAT ENDMILL | H1 | D1 | TOOL DIA. - .5)\nG20", 12.7),
        ("(TOOL -1- MILL DIA 6.0 R0. MM)", 6.0),
        ("(Tool 2: End Mill {6 mm})", 6.0),
        ("(Tool 2: End Mill {0.25 inch})", 6.35),
        ("(T2 End Mill (0.25 inch))", 6.35),
        ("(TC: 6mm Endmill)\nM5\nM6 T2", 6.0),
        ("(TC: 1/4 in Endmill)\nM6 T2\nG21", 6.35),
        ("(TOOL 9: 3MM ENDMILL)", 3.0),
        ("(T9 12MM 4FL ENDMILL)", 12.0),
        ("(T9 10.0 MM DRILL)", 10.0),
        ("(T12 5.MM DRILL)", 5.0),
    ];

    #[test]
    fn what_names_no_tool_is_none() {
        for text in [
            "(T6MM DRILL)",
            "M6 T2 (TOOL CHANGE)",
            "(SEE SHEET - T2)",
            "(TOOL CHANGE)",
            "(T0101)",
            "(TIGHTEN THE VICE 3)",
            "(T3)",
            "(T3 H3)",
        ] {
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

//! What a program's comments state of its stock: a block with its place, or a size alone.
//!
//! | comment | states | written by |
//! |---|---|---|
//! | `(STOCK X0 Y0 Z-20 X100 Y60 Z0)` | two corners | hand |
//! | `(STOCK/BLOCK, 100, 60, 20, 0, 0, 20)` | size, and where the program's zero lies above the lower corner | `CutViewer`'s form, Carbide Create |
//! | `(stockMin: 0mm, 0mm, -20mm)` and `(stockMax: 100mm, 60mm, 0mm)` | two corners | Carbide Create |
//! | `(STOCK 100X60X20)`, `(STOCK = 4. X 2.4 X 0.8)`, `(WORKPIECE SIZE 100X60X20)` | size | hand |
//! | `(STOCK 6061AL DX 4IN DY 2.4IN DZ 0.8IN)` | size | hand |
//! | `(STOCK DIA 32 LENGTH 80)`, `(BAR D32 X 80)`, `(STOCK DIA 32 BORE 12)` | a bar about the work's axis, its face where the machine's file has it | hand |
//! | `( Material Size)` and `( X= 100.000, Y= 60.000, Z= 20.000)` | size | Vectric |
//!
//! Numbers are in the program's unit, where none stands behind them (`MM`, `IN`, `"`). A comment
//! that states a place is taken before one that states only a size.
use super::described::{comments, unit_of};
use super::mill_stock::MilledStock;
use units::MM_PER_INCH;

/// What states that holes are there.
const PRE_DRILLED: &str = "PRE-DRILLED";
/// No stock is larger, mm.
const LARGEST: f64 = 100_000.0;

/// A box, mm: ends along X, Y and Z.
pub(super) type Extent = [[f64; 2]; 3];

/// The stock of which comments tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stated {
    /// Where it lies, mm in G54.
    Block(Extent),
    /// How large it is along X, Y and Z, mm; where it lies is not told.
    Size([f64; 3]),
    /// A bar about the zero of G54 along X and Y, mm.
    Round {
        /// Outer diameter, mm.
        diameter: f64,
        /// Diameter of the hole through it, mm; `None`: it is solid.
        bore: Option<f64>,
        /// Length from its face on, mm; `None`: as the machine's file has it.
        length: Option<f64>,
    },
}

/// Of a program's text.
pub(super) fn stated(text: &str) -> Option<Stated> {
    let unit = unit_of(text);
    let (mut least, mut most, mut size, mut round) = (None, None, None, None);
    let mut is_next = false; // the comment before announced a size
    for comment in comments(text) {
        let upper = comment.trim().to_ascii_uppercase();
        if let Some(rest) = upper.strip_prefix("STOCK/BLOCK") {
            if let [sx, sy, sz, ox, oy, oz] = numbers(rest, unit)[..] {
                return block([-ox, -oy, -oz], [sx - ox, sy - oy, sz - oz]).map(Stated::Block);
            }
        } else if let Some(rest) = upper.strip_prefix("STOCKMIN:") {
            least = <[f64; 3]>::try_from(numbers(rest, unit)).ok();
        } else if let Some(rest) = upper.strip_prefix("STOCKMAX:") {
            most = <[f64; 3]>::try_from(numbers(rest, unit)).ok();
        } else if let Some([a, b]) = upper.strip_prefix("STOCK ").and_then(corners) {
            return block(a.map(|at| at * unit), b.map(|at| at * unit)).map(Stated::Block);
        } else if size.is_none() {
            size = size_of(&upper, is_next, unit);
            round = round.or_else(|| round_of(&upper, unit).filter(|_| size.is_none()));
        }
        is_next = upper.trim_end_matches(':') == "MATERIAL SIZE";
    }
    let between = least.zip(most).and_then(|(a, b)| block(a, b)).map(Stated::Block);
    between.or(size.map(Stated::Size)).or(round)
}

/// `STOCK DIA 32 LENGTH 80`, `BAR 32 MM DIA X 80 LONG`: numbers by the word before or behind them.
fn round_of(upper: &str, unit: f64) -> Option<Stated> {
    let names = ["STOCK", "RAW STOCK", "BAR STOCK", "BAR", "BLANK", "ROUND STOCK"];
    let rest = names.iter().find_map(|name| {
        upper.strip_prefix(name).filter(|rest| !rest.starts_with(|c: char| c.is_alphanumeric()))
    })?;
    let tokens = tokens(rest, unit);
    // what is left on the part, or taken off it
    let other = ["REMOVAL", "ALLOWANCE", "LEFT", "LEAVE", "TO"];
    if tokens.iter().any(|token| matches!(token, Token::Word(word) if other.contains(word))) {
        return None;
    }
    let of = |words: &[&str]| {
        let at = tokens.iter().position(|t| matches!(t, Token::Word(w) if words.contains(w)))?;
        let number = |at: Option<usize>| match tokens.get(at?) {
            Some(Token::Number(value)) if *value > 0.0 && *value < LARGEST => Some((at?, *value)),
            _ => None,
        };
        number(Some(at + 1)).or_else(|| number(at.checked_sub(1)))
    };
    let (at, diameter) = of(&["DIA", "DIAMETER", "DIAM", "D", "OD", "Ø", "⌀", "ROUND"])?;
    let crossed = || {
        // "DIA 32 X 80"
        let times = tokens.iter().skip(at + 1).position(|t| matches!(t, Token::Word("X")))?;
        match tokens.get(at + 2 + times) {
            Some(Token::Number(value)) if *value > 0.0 && *value < LARGEST => Some(*value),
            _ => None,
        }
    };
    let length = of(&["LENGTH", "LEN", "LG", "LONG", "L"]).map(|(_, value)| value).or_else(crossed);
    let bore = of(&["BORE", "ID"]).map(|(_, value)| value);
    (bore.is_none_or(|bore| bore < diameter)).then_some(Stated::Round { diameter, bore, length })
}

/// A word or a number of a comment.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Token<'a> {
    Word(&'a str),
    /// mm.
    Number(f64),
}

fn tokens(text: &str, unit: f64) -> Vec<Token<'_>> {
    let (mut all, mut rest) = (Vec::new(), text);
    while let Some(first) = rest.chars().next() {
        if let Some((value, behind)) = first_number(rest, unit) {
            all.push(Token::Number(value));
            rest = behind;
        } else if first.is_alphabetic() || first == '⌀' {
            let is_symbol = matches!(first, 'Ø' | '⌀');
            let end = rest.find(|c: char| !c.is_alphabetic()).unwrap_or(rest.len());
            let end = if is_symbol { first.len_utf8() } else { end };
            all.push(Token::Word(&rest[..end]));
            rest = &rest[end..];
        } else {
            rest = &rest[first.len_utf8()..];
        }
    }
    all
}

/// A number at the beginning, with its unit, if one begins there.
fn first_number(text: &str, unit: f64) -> Option<(f64, &str)> {
    text.starts_with(|c: char| c.is_ascii_digit() || c == '.').then(|| number(text, unit))?
}

/// A comment states that the holes which the program taps are there: `(PRE-DRILLED)`.
pub(super) fn states_pre_drilled(text: &[u8]) -> bool {
    let text = String::from_utf8_lossy(&text[..text.len().min(MilledStock::LOOKED_AT)]);
    comments(&text).any(|comment| {
        let comment = comment.trim_start();
        comment.get(..PRE_DRILLED.len()).is_some_and(|word| word.eq_ignore_ascii_case(PRE_DRILLED))
    })
}

/// A box between two corners; `None`: it has no volume, or none that fits a machine.
fn block(a: [f64; 3], b: [f64; 3]) -> Option<Extent> {
    let ends = [0, 1, 2].map(|i| [a[i].min(b[i]), a[i].max(b[i])]);
    let fine = |[from, to]: [f64; 2]| to > from && from.abs() < LARGEST && to.abs() < LARGEST;
    ends.into_iter().all(fine).then_some(ends)
}

/// Numbers between commas, mm.
fn numbers(text: &str, unit: f64) -> Vec<f64> {
    let words = text.split([',', ' ']).filter(|word| !word.is_empty());
    words
        .map_while(|word| number(word, unit).filter(|(_, rest)| rest.trim().is_empty()))
        .map(|n| n.0)
        .collect()
}

/// X, Y and Z twice over.
fn corners(text: &str) -> Option<[[f64; 3]; 2]> {
    let mut found = [Vec::new(), Vec::new(), Vec::new()];
    for word in text.split_whitespace() {
        let axis = "XYZ".find(word.chars().next()?)?;
        found[axis].push(word[1..].parse().ok().filter(|v: &f64| v.is_finite())?);
    }
    let [xs, ys, zs] = found;
    let ([x, a], [y, b], [z, c]) = (&xs[..], &ys[..], &zs[..]) else { return None };
    Some([[*x, *y, *z], [*a, *b, *c]])
}

/// A size along X, Y and Z, mm, where the comment is about the stock.
fn size_of(upper: &str, is_announced: bool, unit: f64) -> Option<[f64; 3]> {
    let names = ["STOCK", "RAW STOCK", "BLANK", "MATERIAL SIZE", "WORKPIECE SIZE"];
    let behind = names.iter().find_map(|name| {
        upper.strip_prefix(name).filter(|rest| !rest.starts_with(|c: char| c.is_ascii_alphabetic()))
    });
    let about = behind.or(is_announced.then_some(upper));
    let size = match about {
        Some(text) => labelled(text, unit).or_else(|| {
            let starts =
                text.char_indices().filter(|(at, c)| c.is_ascii_digit() && is_word(text, *at));
            starts.into_iter().find_map(|(at, _)| crossed(&text[at..], unit))
        }),
        // "… SIZE 100X60X20", whatever stands before
        None => upper.split(" SIZE ").nth(1).and_then(|rest| crossed(rest.trim_start(), unit)),
    }?;
    size.iter().all(|side| *side > 0.0 && *side < LARGEST).then_some(size)
}

/// Whether a word begins at this place.
fn is_word(text: &str, at: usize) -> bool {
    !text[..at].ends_with(|c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-'))
}

/// `100 X 60 X 20`.
fn crossed(text: &str, unit: f64) -> Option<[f64; 3]> {
    let times = |rest: &str| {
        let behind = rest.trim_start().strip_prefix('X')?.trim_start();
        Some(rest.len() - behind.len())
    };
    let (x, rest) = number(text, unit)?;
    let (y, rest) = number(&rest[times(rest)?..], unit)?;
    let (z, rest) = number(&rest[times(rest)?..], unit)?;
    (!rest.starts_with(|c: char| c.is_ascii_alphanumeric())).then_some([x, y, z])
}

/// `X100 Y60 Z20`, `DX 4IN DY 2.4IN DZ 0.8IN`, `X= 100., Y= 60., Z= 20.`: each axis once.
fn labelled(text: &str, unit: f64) -> Option<[f64; 3]> {
    let side = |axis: char| {
        let mut found = text.match_indices(axis).filter_map(|(at, _)| {
            let before = text[..at].strip_suffix('D').unwrap_or(&text[..at]);
            let behind = text[at + 1..].trim_start().trim_start_matches(['=', ':']).trim_start();
            let is_label = is_word(text, before.len());
            number(behind, unit).filter(|_| is_label)
        });
        let (side, rest) = found.next()?;
        (found.next().is_none() && ends(rest)).then_some(side)
    };
    Some([side('X')?, side('Y')?, side('Z')?])
}

/// A number at the beginning, mm, and what stands behind it and its unit.
fn number(text: &str, unit: f64) -> Option<(f64, &str)> {
    let end = text.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+')));
    let (digits, rest) = text.split_at(end.unwrap_or(text.len()));
    let value: f64 = digits.parse().ok().filter(|v: &f64| v.is_finite())?;
    let units = [
        ("MM", 1.0),
        ("INCHES", MM_PER_INCH),
        ("INCH", MM_PER_INCH),
        ("IN", MM_PER_INCH),
        ("\"", MM_PER_INCH),
    ];
    for (name, mm) in units {
        if let Some(behind) = rest.trim_start().strip_prefix(name)
            && ends(behind)
        {
            return Some((value * mm, behind));
        }
    }
    Some((value * unit, rest))
}

/// Whether a number, or its unit, ends before this text: the next axis may follow at once.
fn ends(behind: &str) -> bool {
    !behind.starts_with(|c: char| c.is_ascii_alphanumeric() && !"XYZD".contains(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_state_the_stock() {
        let plate = Some(Stated::Block([[0.0, 100.0], [-5.0, 60.0], [-20.0, 0.0]]));
        for text in [
            "(STOCK X0 Y-5 Z-20 X100 Y60 Z0)\nG0 X0",
            "%\n(T1 D=6. flat end mill)\n(stock x100 y60 z0 x0 y-5 z-20)",
            "(STOCK/BLOCK, 100, 65, 20, 0, 5, 20)",
            "; STOCK/BLOCK,100.0,65.0,20.0,0.0,5.0,20.0",
            "(stockMin: 0.00, -5.00, -20.00)\n(stockMax: 100.00, 60.00, 0.00)",
            "(stockMin:0.00mm, -5.00mm, -20.00mm)\n(stockMax:100.00mm, 60.00mm, 0.00mm)",
            "(STOCK 1X2X3)\n(STOCK X0 Y-5 Z-20 X100 Y60 Z0)",
        ] {
            assert_eq!(stated(text), plate, "{text}");
        }
        let inch = stated("G20\n(STOCK X0 Y0 Z-1 X4 Y2 Z0)");
        let block = Stated::Block([[0.0, 101.6], [0.0, 50.8], [-25.4, 0.0]]);
        assert_eq!(inch, Some(block));
    }

    /// The forms as shops and posts write them; an inch is 25.4 mm.
    #[test]
    fn comments_state_a_size_alone() {
        let near = |text: &str, size: [f64; 3]| match stated(text) {
            Some(Stated::Size(found)) => {
                let off = (0..3).map(|i| (found[i] - size[i]).abs()).fold(0.0, f64::max);
                assert!(off < 1e-9, "{text}: {found:?}");
            }
            other => panic!("{text}: {other:?}"),
        };
        near("(STOCK 100X80X20)", [100.0, 80.0, 20.0]);
        near("(stock: 100 x 80 x 20 mm)", [100.0, 80.0, 20.0]);
        near("(STOCK SIZE 100mm x 80mm x 20mm)", [100.0, 80.0, 20.0]);
        near("G20\n(STOCK = 3.6 X 2. X 1.)", [91.44, 50.8, 25.4]);
        near("G21\n(STOCK 6061AL DX 3.5IN DY 2.0IN DZ 1.0IN)", [88.9, 50.8, 25.4]);
        near("(STOCK 6061AL DX 3.3IN DY 1.8IN DZ 0.6IN, AFTER SQUARING)", [83.82, 45.72, 15.24]);
        near("( Material Size)\n( X= 76.000, Y= 5.500 ,Z= 1.000)", [76.0, 5.5, 1.0]);
        near("N2; Material Size: X76.2000 Y50.8000 Z38.1000", [76.2, 50.8, 38.1]);
        near("(INFO. // WORKPICE SIZE 50X25X5 MATERIAL:ALUMINIUM)", [50.0, 25.0, 5.0]);
        near("(STOCK 100X80X5 INSERTS)", [100.0, 80.0, 5.0]);
        near("(RAW STOCK X100 Y60 Z20)", [100.0, 60.0, 20.0]);
        near("(STOCK 4\" X 2\" X 1\")", [101.6, 50.8, 25.4]);
    }

    #[test]
    fn comments_state_a_bar() {
        let bar = |text: &str| match stated(text) {
            Some(Stated::Round { diameter, bore, length }) => (diameter, bore, length),
            other => panic!("{text}: {other:?}"),
        };
        let (plain, long) = ((32.0, None, None), (32.0, None, Some(80.0)));
        for text in
            ["(STOCK DIA 32)", "(Stock: dia. 32 mm)", "(BAR D32)", "(STOCK ⌀32)", "(STOCK 32 DIA)"]
        {
            assert_eq!(bar(text), plain, "{text}");
        }
        for text in [
            "(STOCK DIA 32 LENGTH 80)",
            "(STOCK DIAMETER=32 LENGTH=80)",
            "(BAR STOCK 32 MM DIA X 80 MM LONG)",
            "(STOCK D32 L80)",
            "(STOCK ROUND 32 X 80)",
        ] {
            assert_eq!(bar(text), long, "{text}");
        }
        assert_eq!(bar("(STOCK DIA 32 BORE 12.5 LENGTH 80)"), (32.0, Some(12.5), Some(80.0)));
        assert_eq!(bar("G20\n(STOCK DIA 1.25 LENGTH 3)"), (31.75, None, Some(3.0 * 25.4)));
        assert_eq!(bar("G21\n(STOCK DIA 1.25 IN)"), (31.75, None, None));
    }

    #[test]
    fn what_states_no_size_is_no_stock() {
        for text in [
            "(STOCK/BLOCK, 100, 60, 20)",
            "(STOCK X0 Y0 Z0 X0 Y60 Z20)",
            "(STOCK X0 Y0 Z0)",
            "(STOCK X100 Y60 Z-20)",
            "(STOCK DIAMETER)",
            "(STOCK DIA 0)",
            "(STOCK DIA 20 BORE 25)",
            "(STOCK REMOVAL D1)",
            "(BARREL DIA 32)",
            "(STOCK 6061AL DX 3.8IN DY 1.8N DZ 0.9IN)",
            "(STOCK 100X80)",
            "(STOCK 100X80X20X5)",
            "(STOCK 100X80X20A)",
            "(STOCKS 100X80X20)",
            "(FACE STOCK)",
            "( X= 76.000, Y= 5.500, Z= 1.000)",
            "(G54 X0Y0 - REAR LEFT CORNER OF STOCK)",
            "(SCALE SIZE)",
            "(stockMin: 0, 0, 0)",
            "(STOCK/BLOCK, 1e300, 1e300, 1e300, 0, 0, 0)",
            "(STOCK ü)",
        ] {
            assert_eq!(stated(text), None, "{text}");
        }
    }
}

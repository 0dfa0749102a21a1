//! Words that count or name something: whole numbers, whatever the least input increment is, with a
//! point or without.
//!
//! ```text
//!   G51.2 P1 Q2       two turns of the cutter for one of the work, and not 0.002
//!   G81 T40 L1 Q2     40 teeth, module 2
//!   M19 R90           90 degrees
//!   G71 P10 Q20       the blocks N10 to N20
//! ```
//!
//! The letters D, F, H, L, M, N, O, P, S and T count in no increments beside any code, but for the
//! times and depths that a code makes of P and D; the table has what would be a length or an angle
//! elsewhere, and what a code counts beside it.
//!
//! Source: Fanuc, operator's manual of series 30i (B-63944EN), "Polygon turning", "Hobbing
//! function", "Subprogram", "Multiple repetitive cycle"; Haas, mill operator's manual, M19.
use crate::{
    codes::number::tenths,
    dialect::{Dialect, fanuc::kind::Kind, rules::FrontEndKind},
};

/// Codes, in tenths, and the letters that count or name something beside them.
struct Counting {
    letter: u8,
    codes: &'static [u16],
    letters: &'static [u8],
    /// Where these codes are a lathe's.
    on_lathes: bool,
}

const fn row(letter: u8, codes: &'static [u16], letters: &'static [u8]) -> Counting {
    Counting { letter, codes, letters, on_lathes: false }
}

/// Words that count, by rising code of the block they stand in.
const TABLE: &[Counting] = &[
    row(b'G', &[100], b"LPQ"),    // offsets: which, and the number of a nose
    row(b'G', &[300, 541], b"P"), // the second reference point, further work offsets
    row(b'G', &[512, 514, 2510], b"LPQ"), // turns of a polygon
    row(b'G', &[513], b"L"),      // periods of its oscillation
    row(b'G', &[650, 660], b"LP"), // macros: which, and how often
    row(b'M', &[970, 980, 990, 1980], b"HLPQ"), // subprograms: which, how often, from which block on
    row(b'M', &[190], b"PR"),                   // degrees
    Counting { on_lathes: true, ..row(b'G', &[700, 710, 720, 730], b"PQ") }, // blocks of a profile
];
/// Teeth, starts, module and helix of G81 that hobs.
const HOBBING: &[u8] = b"LPQT";

/// Letters that count or name something beside a code, in tenths.
pub(crate) fn counting(kind: Kind, letter: u8, code: u16) -> &'static [u8] {
    let code = if letter == b'G' { kind.common(code).unwrap_or(code) } else { code };
    let is_meant = |row: &&Counting| {
        row.letter == letter && row.codes.contains(&code) && (!row.on_lathes || kind.is_lathe())
    };
    TABLE.iter().find(is_meant).map_or(b"", |row| row.letters)
}

/// The same beside the words of a block: its G81 without an axis word gears a hob's work.
pub(crate) fn counts(kind: Kind, words: &[(u8, f64)], letter: u8) -> bool {
    if gears_hob(words) && HOBBING.contains(&letter) {
        return true;
    }
    words.iter().filter(|(of, _)| matches!(of, b'G' | b'M')).any(|(of, code)| {
        tenths(*code).is_some_and(|code| counting(kind, *of, code).contains(&letter))
    })
}

/// Whether a block begins hobbing: G81 with T, L or Q, and no axis word.
pub(crate) fn gears_hob(words: &[(u8, f64)]) -> bool {
    let has = |letters: &[u8]| words.iter().any(|(letter, _)| letters.contains(letter));
    words.contains(&(b'G', 81.0)) && has(b"TLQ") && !has(b"XYZUVWABCR")
}

/// Codes of a dialect, as it writes them, with the letters that count or name something beside
/// them.
pub fn counting_words(dialect: Dialect) -> Vec<(String, &'static str)> {
    let FrontEndKind::Fanuc(kind) = dialect.rules().front_end else { return Vec::new() };
    let rows = TABLE.iter().filter(|row| !row.on_lathes || kind.is_lathe());
    let codes = rows.flat_map(|row| row.codes.iter().map(move |code| (row, *code)));
    let written = codes.map(|(row, code)| {
        let own = if code.is_multiple_of(10) { kind.own(code / 10) * 10 } else { code };
        let own = if row.letter == b'G' { own } else { code };
        let code = crate::codes::spelling::written(own);
        let letters = core::str::from_utf8(row.letters).unwrap_or_default();
        (format!("{}{code}", char::from(row.letter)), letters)
    });
    let hobbing = core::str::from_utf8(HOBBING).unwrap_or_default();
    written.chain(kind.is_mill().then(|| ("G81".to_owned(), hobbing))).collect()
}

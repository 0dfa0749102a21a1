//! Thread sizes: what a designation says, and the basic profile it means.
//!
//! ```text
//!        ├─ P ─┤                    H  = √3/2 · P          height of the sharp triangle
//!    ___       ___   ── D           D2 = D − 3/4 · H       = D − 0.649519 · P
//!   /   \     /   \  ── D2          D1 = D − 5/4 · H       = D − 1.082532 · P
//!  /     \___/     \ ── D1          (ISO 68-1; ASME B1.1 has the same profile)
//! ```
//!
//! | written | means |
//! |---|---|
//! | `M6`, `M 8 x 1`, `M8-1.25` | ISO metric: nominal diameter and pitch; without pitch the coarse one of ISO 261 |
//! | `1/4-20 UNC`, `1 1/8-7`, `0.25-28` | unified (ASME B1.1): nominal diameter in inches, threads per inch |
//! | `#10-32`, `10-32`, `No.10-32` | number size n: 0.060 in + 0.013 in × n |
//! | `-LH`, `left` at the end | left-hand |
//! | `-6H`, `-2B` at the end | a class: read over, a tap's own pitch diameter is [`TapTool::oversize`](crate::TapTool::oversize) |
//!
//! A name that contradicts its series ("1/4-28 UNC") is refused: one of the two is a slip, and
//! it is not known which.
use alloc::{
    format,
    string::{String, ToString},
};
use core::{fmt, ops::RangeInclusive, str::FromStr};
use units::{Lead, Length};

/// Nominal diameters and coarse pitches of ISO 261, mm.
pub(crate) const COARSE_MM: [(f64, f64); 34] = [
    (1.0, 0.25),
    (1.2, 0.25),
    (1.4, 0.3),
    (1.6, 0.35),
    (1.8, 0.35),
    (2.0, 0.4),
    (2.5, 0.45),
    (3.0, 0.5),
    (3.5, 0.6),
    (4.0, 0.7),
    (5.0, 0.8),
    (6.0, 1.0),
    (7.0, 1.0),
    (8.0, 1.25),
    (10.0, 1.5),
    (12.0, 1.75),
    (14.0, 2.0),
    (16.0, 2.0),
    (18.0, 2.5),
    (20.0, 2.5),
    (22.0, 2.5),
    (24.0, 3.0),
    (27.0, 3.0),
    (30.0, 3.5),
    (33.0, 3.5),
    (36.0, 4.0),
    (39.0, 4.0),
    (42.0, 4.5),
    (45.0, 4.5),
    (48.0, 5.0),
    (52.0, 5.0),
    (56.0, 5.5),
    (60.0, 5.5),
    (64.0, 6.0),
];

/// Unified threads of ASME B1.1: nominal diameter in inches, threads per inch of the coarse and of
/// the fine series; 0 where there is none.
pub(crate) const UNIFIED: [(f64, f64, f64); 26] = [
    (0.060, 0.0, 80.0),
    (0.073, 64.0, 72.0),
    (0.086, 56.0, 64.0),
    (0.099, 48.0, 56.0),
    (0.112, 40.0, 48.0),
    (0.125, 40.0, 44.0),
    (0.138, 32.0, 40.0),
    (0.164, 32.0, 36.0),
    (0.190, 24.0, 32.0),
    (0.216, 24.0, 28.0),
    (1.0 / 4.0, 20.0, 28.0),
    (5.0 / 16.0, 18.0, 24.0),
    (3.0 / 8.0, 16.0, 24.0),
    (7.0 / 16.0, 14.0, 20.0),
    (1.0 / 2.0, 13.0, 20.0),
    (9.0 / 16.0, 12.0, 18.0),
    (5.0 / 8.0, 11.0, 18.0),
    (3.0 / 4.0, 10.0, 16.0),
    (7.0 / 8.0, 9.0, 14.0),
    (1.0, 8.0, 12.0),
    (1.125, 7.0, 12.0),
    (1.25, 7.0, 12.0),
    (1.375, 6.0, 12.0),
    (1.5, 6.0, 12.0),
    (1.75, 5.0, 0.0),
    (2.0, 4.5, 0.0),
];

/// Nominal diameters that can be meant, mm: from the smallest of ISO 965-1 to far beyond any tap.
const NOMINAL_MM: RangeInclusive<f64> = 0.9..=400.0;
/// Finest pitch that can be meant, mm.
const FINEST_MM: f64 = 0.1;
/// Coarsest pitch that can be meant, as a share of the nominal diameter: no core is left beyond it.
const COARSEST_SHARE: f64 = 0.5;
/// Longer than any designation, bytes.
const LONGEST: usize = 64;
const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// Whose system of sizes and tolerances a thread belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Family {
    /// ISO metric.
    Metric,
    /// Unified inch.
    Unified,
}

/// Which way a thread winds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Hand {
    /// Screws in clockwise.
    Right,
    /// Screws in counter-clockwise.
    Left,
}

impl Hand {
    /// `"right"` or `"left"`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Left => "left",
        }
    }

    /// +1 for right, −1 for left.
    pub const fn sign(self) -> f64 {
        match self {
            Self::Right => 1.0,
            Self::Left => -1.0,
        }
    }
}

/// Size and hand of a single-start thread.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreadSize {
    /// How it is written, such as `"M6x1"` or `"1/4-20 UNC"`; without hand and class.
    pub designation: String,
    /// Whose system it belongs to.
    pub family: Family,
    /// Nominal diameter D: major diameter of the internal thread.
    pub nominal: Length,
    /// Pitch P: the lead's magnitude.
    pub pitch: Length,
    /// Which way it winds.
    pub hand: Hand,
}

impl ThreadSize {
    /// A metric thread of any diameter and pitch.
    pub fn metric(nominal: Length, pitch: Length, hand: Hand) -> Self {
        let designation = format!("M{}x{}", short(nominal.value()), short(pitch.value()));
        Self { designation, family: Family::Metric, nominal, pitch, hand }
    }

    /// Lead of the helix; negative for a left-hand thread.
    pub fn lead(&self) -> Lead {
        Lead::mm_per_rev(self.pitch.value() * self.hand.sign())
    }

    /// Basic pitch diameter D2.
    pub fn pitch_diameter(&self) -> Length {
        self.nominal - self.pitch * (3.0 / 8.0 * SQRT_3)
    }

    /// Basic minor diameter D1.
    pub fn minor_diameter(&self) -> Length {
        self.nominal - self.pitch * (5.0 / 8.0 * SQRT_3)
    }

    /// What a shop drills for it where nothing else is known: D − P.
    pub fn tap_drill(&self) -> Length {
        self.nominal - self.pitch
    }
}

/// At most four decimals, more than any designation has: a finer remainder is arithmetic.
fn short(value_mm: f64) -> String {
    format!("{value_mm:.4}").trim_end_matches('0').trim_end_matches('.').to_string()
}

/// A designation that names no thread.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownSize(String);

impl fmt::Display for UnknownSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "expected a thread such as \"M6\", \"M8x1.25-LH\", \"1/4-20 UNC\" or \"#10-24\", found \"{}\"",
            self.0
        )
    }
}

impl core::error::Error for UnknownSize {}

impl FromStr for ThreadSize {
    type Err = UnknownSize;

    fn from_str(text: &str) -> Result<Self, UnknownSize> {
        let unknown = || UnknownSize(text.chars().take(40).collect());
        if text.len() > LONGEST {
            return Err(unknown());
        }
        let mut upper = text.trim().to_ascii_uppercase();
        upper.retain(|c| c != '"');
        let (bare, hand) = without_suffixes(&upper);
        let size = match bare.strip_prefix('M') {
            Some(rest) => metric(rest, hand),
            None => unified(bare, hand),
        };
        size.filter(|size| {
            NOMINAL_MM.contains(&size.nominal.value())
                && size.pitch > Length::mm(FINEST_MM)
                && size.pitch < size.nominal * COARSEST_SHARE
        })
        .ok_or_else(unknown)
    }
}

/// The designation without hand and class at its end.
fn without_suffixes(text: &str) -> (&str, Hand) {
    let mut bare = text;
    let mut hand = Hand::Right;
    loop {
        let trimmed = bare.trim_end_matches(['-', ' ']);
        let Some((at, word)) = last_word(trimmed) else { return (trimmed, hand) };
        match word {
            "LH" | "LEFT" => hand = Hand::Left,
            "RH" | "RIGHT" => hand = Hand::Right,
            _ if is_class(word) => {}
            _ => return (trimmed, hand),
        }
        bare = &trimmed[..at];
    }
}

/// What stands behind the last dash or blank, and where it begins.
fn last_word(text: &str) -> Option<(usize, &str)> {
    let at = text.rfind(['-', ' '])? + 1;
    Some((at, &text[at..]))
}

/// "6H", "4H5H", "6G", "2B", "3BX": a digit, then letters G, H, B, X and digits.
fn is_class(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_digit())
        && word.ends_with(['G', 'H', 'B', 'X'])
        && word.chars().all(|c| c.is_ascii_digit() || matches!(c, 'G' | 'H' | 'B' | 'X'))
        && word.contains(['G', 'H', 'B'])
}

/// What stands behind the M: "6", "6X1", "8-1.25".
fn metric(rest: &str, hand: Hand) -> Option<ThreadSize> {
    let mut parts = rest.split(['X', '×', '*', '-']).map(str::trim);
    let nominal_mm = number(parts.next()?)?;
    let pitch_mm = match parts.next() {
        Some(pitch) => number(pitch)?,
        None => COARSE_MM.iter().find(|(d, _)| *d == nominal_mm)?.1,
    };
    let size = ThreadSize::metric(Length::mm(nominal_mm), Length::mm(pitch_mm), hand);
    parts.next().is_none().then_some(size)
}

/// "1/4-20 UNC", "#10-24", "1 1/8-7".
fn unified(text: &str, hand: Hand) -> Option<ThreadSize> {
    const SERIES: [&str; 7] = ["UNEF", "UNJC", "UNJF", "UNC", "UNF", "UNS", "UN"];
    let stated = SERIES.into_iter().find(|series| text.ends_with(series));
    let bare = stated.map_or(text, |series| &text[..text.len() - series.len()]);
    let bare = bare.trim_end_matches(['-', ' ']);
    let (at, per_inch) = last_word(bare)?;
    let per_inch = number(per_inch).filter(|n| *n > 0.0)?;
    let (written, inches) = inches(bare[..at].trim_end_matches(['-', ' ']), per_inch)?;
    let series = series(stated, inches, per_inch)?;
    Some(ThreadSize {
        designation: format!("{written}-{per_inch} {series}"),
        family: Family::Unified,
        nominal: Length::inch(inches),
        pitch: Length::inch(1.0 / per_inch),
        hand,
    })
}

/// The series as it is stated, or as the standard has it; nothing where the two contradict each
/// other.
fn series(stated: Option<&'static str>, inches: f64, per_inch: f64) -> Option<&'static str> {
    let known = UNIFIED.iter().find(|(nominal, ..)| (nominal - inches).abs() < 1e-9);
    let standard = match known {
        Some((_, coarse, _)) if *coarse == per_inch => "UNC",
        Some((.., fine)) if *fine == per_inch => "UNF",
        _ => "UN",
    };
    match stated {
        Some("UNC" | "UNF") if known.is_some() && stated != Some(standard) => None,
        Some(stated) => Some(stated),
        None => Some(standard),
    }
}

/// How a unified diameter is written, and its inches. A bare whole number is a number size if its
/// pitch is one of theirs: none of them has fewer than 24 threads per inch, no inch size of a whole
/// number more.
fn inches(text: &str, per_inch: f64) -> Option<(String, f64)> {
    const LARGEST_NUMBER: u32 = 14;
    let numbered = |n: u32| {
        let inches = 0.060 + 0.013 * f64::from(n);
        (n <= LARGEST_NUMBER).then(|| (format!("#{n}"), inches))
    };
    for prefix in ["#", "NO.", "NO"] {
        if let Some(rest) = text.strip_prefix(prefix) {
            return numbered(rest.trim().parse().ok()?);
        }
    }
    if let Some(n) = text.parse().ok().filter(|_| per_inch >= 24.0) {
        return numbered(n);
    }
    let Some((top, bottom)) = text.split_once('/') else {
        return Some((text.into(), number(text)?));
    };
    let fraction = |top: &str| Some(number(top)? / number(bottom).filter(|n| *n > 0.0)?);
    match top.rsplit_once([' ', '-']) {
        Some((whole, top)) => {
            let whole = number(whole)?;
            Some((format!("{whole}-{top}/{bottom}"), whole + fraction(top)?))
        }
        None => Some((text.into(), fraction(top)?)),
    }
}

/// A plain decimal number without sign.
fn number(text: &str) -> Option<f64> {
    let plain = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    let value: f64 = plain.then(|| text.parse().ok())??;
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn check(text: &str, designation: &str, nominal_mm: f64, lead_mm: f64) {
        let size: ThreadSize = text.parse().unwrap();
        assert_eq!(size.designation, designation, "{text}");
        assert!((size.nominal.value() - nominal_mm).abs() < 1e-9, "{text}: {}", size.nominal);
        assert!((size.lead().value() - lead_mm).abs() < 1e-9, "{text}: {}", size.lead());
        let again: ThreadSize = designation.parse().unwrap();
        assert_eq!((again.designation, again.nominal), (size.designation, size.nominal));
    }

    #[test]
    fn a_metric_size_may_leave_out_its_coarse_pitch() {
        check("M6", "M6x1", 6.0, 1.0);
        check("m2.5", "M2.5x0.45", 2.5, 0.45);
        check("M6x1", "M6x1", 6.0, 1.0);
        check("M 10 x 1.25", "M10x1.25", 10.0, 1.25);
        check("M 8 x 1.0", "M8x1", 8.0, 1.0);
        check("M8-1.25", "M8x1.25", 8.0, 1.25);
    }

    #[test]
    fn hand_and_class_stand_at_the_end_in_any_order() {
        check("M8x1.25-LH", "M8x1.25", 8.0, -1.25);
        check("M8x1.25 - 6H - LH", "M8x1.25", 8.0, -1.25);
        check("M6 LH", "M6x1", 6.0, -1.0);
        check("M6-6H", "M6x1", 6.0, 1.0);
        check("1/4-20UNC-2B-LH", "1/4-20 UNC", 6.35, -1.27);
        check("1/4-20 UNC LH", "1/4-20 UNC", 6.35, -1.27);
    }

    #[test]
    fn an_inch_size_is_a_fraction_a_decimal_or_a_number_and_named_by_its_series() {
        check("1/4-20", "1/4-20 UNC", 6.35, 1.27);
        check("1/4-28", "1/4-28 UNF", 6.35, 25.4 / 28.0);
        check("1/4-32 UNEF", "1/4-32 UNEF", 6.35, 25.4 / 32.0);
        check("#10-24", "#10-24 UNC", 0.19 * 25.4, 25.4 / 24.0);
        check("10-32 UNF", "#10-32 UNF", 0.19 * 25.4, 25.4 / 32.0);
        check("1 1/8-7 UNC", "1-1/8-7 UNC", 1.125 * 25.4, 25.4 / 7.0);
        check("1-1/4-7", "1-1/4-7 UNC", 31.75, 25.4 / 7.0);
        check("1-8 UNC", "1-8 UNC", 25.4, 25.4 / 8.0);
        check("1-64", "#1-64 UNC", 0.073 * 25.4, 25.4 / 64.0);
        check("2-4.5", "2-4.5 UNC", 50.8, 25.4 / 4.5);
        check("0.250-20", "0.250-20 UNC", 6.35, 1.27);
        check("0.3-20", "0.3-20 UN", 7.62, 1.27);
    }

    #[test]
    fn what_names_no_thread_or_contradicts_its_series_is_refused_and_quoted() {
        for text in [
            "",
            "M",
            "M0",
            "M6x",
            "M6x0",
            "M6x6",
            "M6x7",
            "M6xNaN",
            "Minf",
            "M5.5",
            "M9",
            "1/0-20",
            "1/4-0",
            "G1/4",
            "1/4",
            "M6x1x2",
            "-20",
            "-LH",
            "6 mm",
            "x",
            "1/4-28 UNC",
            "1/4-20 UNF",
            "#15-24",
        ] {
            let refused = text.parse::<ThreadSize>().unwrap_err().to_string();
            assert!(refused.ends_with(&format!("found \"{text}\"")), "{refused}");
        }
    }

    #[test]
    fn basic_diameters_are_those_of_iso_724_and_asme_b1_1() {
        let m6: ThreadSize = "M6".parse().unwrap();
        assert!((m6.pitch_diameter().value() - 5.350).abs() < 0.0006);
        assert!((m6.minor_diameter().value() - 4.917).abs() < 0.0006);
        let quarter: ThreadSize = "1/4-20 UNC".parse().unwrap();
        assert!((quarter.pitch_diameter().value() / 25.4 - 0.2175).abs() < 0.00006);
        assert!((quarter.minor_diameter().value() / 25.4 - 0.1959).abs() < 0.00006);
    }

    proptest! {
        #[test]
        fn no_text_makes_the_reader_panic(text in "\\PC{0,70}") {
            let _ = text.parse::<ThreadSize>();
        }

        #[test]
        fn nearly_right_text_does_not_either(text in "[M#0-9xX/. \\-UNCFLHB\"]{0,16}") {
            if let Ok(size) = text.parse::<ThreadSize>() {
                prop_assert!(size.pitch_diameter() > size.minor_diameter());
                prop_assert!(size.minor_diameter() > Length::ZERO || size.pitch > size.nominal * 0.46);
            }
        }
    }
}

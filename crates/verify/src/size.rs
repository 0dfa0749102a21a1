//! Thread sizes: what a designation says, and the basic profile it means.
//!
//! ```text
//!        ├─ P ─┤                    H  = √3/2 · P          height of the sharp triangle
//!    ___       ___   ── D           D2 = D − 3/4 · H       = D − 0.649519 · P
//!   /   \     /   \  ── D2          D1 = D − 5/4 · H       = D − 1.082532 · P
//!  /     \___/     \ ── D1          (ISO 68-1; ASME B1.1 has the same profile)
//! ```
//!
//! Read are ISO metric sizes ("M6", "M6x1", "M8x1.25-LH", "M10-6H") and unified inch sizes
//! ("1/4-20 UNC", "#10-24", "1 1/8-7 UNC-2B-LH"). A class in a tap's designation is read over: the
//! tap's own pitch diameter is `TapTool::oversize`. Coarse pitches are those of ISO 261.
use crate::class::Family;
use crate::feature::Hand;
use std::fmt;
use std::str::FromStr;
use units::{Lead, Length};

/// Nominal diameters and coarse pitches of ISO 261, mm.
const COARSE_MM: [(f64, f64); 31] = [
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
    (48.0, 5.0),
    (56.0, 5.5),
    (64.0, 6.0),
];

/// Nominal diameters that can be meant, mm: from the smallest of ISO 965-1 to far beyond any tap.
const NOMINAL_MM: std::ops::RangeInclusive<f64> = 0.9..=400.0;

/// A thread's size and hand.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreadSize {
    /// How it is written, such as `"M6x1"`; without hand and class.
    pub designation: String,
    /// Whose system it belongs to.
    pub family: Family,
    /// Nominal diameter D: major diameter of the internal thread.
    pub nominal: Length,
    /// Pitch P: the lead of these single-start threads.
    pub pitch: Length,
    /// Which way it winds.
    pub hand: Hand,
}

impl ThreadSize {
    /// A metric thread of any diameter and pitch.
    pub fn metric(nominal: Length, pitch: Length, hand: Hand) -> Self {
        Self {
            designation: format!("M{}x{}", rounded(nominal.value()), rounded(pitch.value())),
            family: Family::Metric,
            nominal,
            pitch,
            hand,
        }
    }

    /// Lead of the helix, magnitude.
    pub fn lead(&self) -> Lead {
        Lead::mm_per_rev(self.pitch.value())
    }

    /// Basic pitch diameter D2.
    pub fn pitch_diameter(&self) -> Length {
        self.nominal - self.pitch * (3.0 / 8.0 * 3.0_f64.sqrt())
    }

    /// Basic minor diameter D1.
    pub fn minor_diameter(&self) -> Length {
        self.nominal - self.pitch * (5.0 / 8.0 * 3.0_f64.sqrt())
    }

    /// What a shop drills for it where nothing else is known: D − P.
    pub fn tap_drill(&self) -> Length {
        self.nominal - self.pitch
    }

    /// Longest engagement for which the tolerances of a normal length ("N") hold:
    /// 6.7·P·d^0.2 (ISO 965-1; d taken as the nominal diameter).
    pub fn normal_engagement(&self) -> Length {
        self.pitch * (6.7 * self.nominal.value().powf(0.2))
    }
}

/// Four decimals are more than any designation has; a finer remainder is arithmetic.
fn rounded(value_mm: f64) -> f64 {
    (value_mm * 1e4).round() / 1e4
}

/// A designation that names no thread judged here.
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

impl std::error::Error for UnknownSize {}

impl FromStr for ThreadSize {
    type Err = UnknownSize;

    fn from_str(text: &str) -> Result<Self, UnknownSize> {
        let unknown = || UnknownSize(text.chars().take(40).collect());
        if text.len() > 64 {
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
                && size.pitch > Length::mm(0.1)
                && size.pitch < size.nominal * 0.5
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
    parts
        .next()
        .is_none()
        .then(|| ThreadSize::metric(Length::mm(nominal_mm), Length::mm(pitch_mm), hand))
}

/// "1/4-20 UNC", "#10-24", "1 1/8-7".
fn unified(text: &str, hand: Hand) -> Option<ThreadSize> {
    const SERIES: [&str; 7] = ["UNEF", "UNJC", "UNJF", "UNC", "UNF", "UNS", "UN"];
    let series = SERIES.into_iter().find(|series| text.ends_with(series));
    let bare = series.map_or(text, |series| &text[..text.len() - series.len()]);
    let bare = bare.trim_end_matches(['-', ' ']);
    let (at, threads_per_inch) = last_word(bare)?;
    let threads_per_inch = number(threads_per_inch)?;
    let written = bare[..at].trim_end_matches(['-', ' ']);
    let nominal_inch = inches(written, threads_per_inch)?;
    let designation = match series {
        Some(series) => format!("{written}-{threads_per_inch} {series}"),
        None => format!("{written}-{threads_per_inch}"),
    };
    Some(ThreadSize {
        designation,
        family: Family::Unified,
        nominal: Length::inch(nominal_inch),
        pitch: Length::inch(1.0 / threads_per_inch),
        hand,
    })
}

/// Diameter in inches: number sizes are 0.060 + 0.013·n. A bare whole number is a number size if its
/// pitch is one of theirs: none of them has fewer than 24 threads per inch, no inch size more.
fn inches(text: &str, threads_per_inch: f64) -> Option<f64> {
    let numbered = |n: f64| (n <= 12.0 && n.fract() == 0.0).then_some(0.060 + 0.013 * n);
    for prefix in ["#", "NO.", "NO"] {
        if let Some(rest) = text.strip_prefix(prefix) {
            return numbered(number(rest.trim())?);
        }
    }
    let (whole, fraction) = match text.rsplit_once([' ', '-']) {
        Some((whole, fraction)) if fraction.contains('/') => (number(whole)?, fraction),
        Some(_) => return None,
        None => (0.0, text),
    };
    match fraction.split_once('/') {
        Some((top, bottom)) => Some(whole + number(top)? / number(bottom)?),
        None if !text.contains('.') && threads_per_inch >= 24.0 => numbered(number(text)?),
        None => number(text),
    }
}

/// A plain positive decimal number.
fn number(text: &str) -> Option<f64> {
    let plain = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    let value: f64 = plain.then(|| text.parse().ok())??;
    (value.is_finite() && value >= 0.0).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn check(text: &str, designation: &str, nominal_mm: f64, pitch_mm: f64, hand: Hand) {
        let size: ThreadSize = text.parse().unwrap();
        assert_eq!(size.designation, designation, "{text}");
        assert!((size.nominal.value() - nominal_mm).abs() < 1e-9, "{text}: {}", size.nominal);
        assert!((size.pitch.value() - pitch_mm).abs() < 1e-9, "{text}: {}", size.pitch);
        assert_eq!(size.hand, hand, "{text}");
    }

    #[test]
    fn a_metric_size_may_leave_out_its_coarse_pitch() {
        check("M6", "M6x1", 6.0, 1.0, Hand::Right);
        check("m2.5", "M2.5x0.45", 2.5, 0.45, Hand::Right);
        check("M6x1", "M6x1", 6.0, 1.0, Hand::Right);
        check("M 10 x 1.25", "M10x1.25", 10.0, 1.25, Hand::Right);
        check("M8-1.25", "M8x1.25", 8.0, 1.25, Hand::Right);
    }

    #[test]
    fn hand_and_class_stand_at_the_end_in_any_order() {
        check("M8x1.25-LH", "M8x1.25", 8.0, 1.25, Hand::Left);
        check("M8x1.25 - 6H - LH", "M8x1.25", 8.0, 1.25, Hand::Left);
        check("M6-6H", "M6x1", 6.0, 1.0, Hand::Right);
        check("1/4-20UNC-2B-LH", "1/4-20 UNC", 6.35, 1.27, Hand::Left);
        check("1/4-20 UNC LH", "1/4-20 UNC", 6.35, 1.27, Hand::Left);
    }

    #[test]
    fn an_inch_size_is_a_fraction_a_decimal_or_a_number() {
        check("1/4-20 UNC", "1/4-20 UNC", 6.35, 1.27, Hand::Right);
        check("#10-24", "#10-24", 0.19 * 25.4, 25.4 / 24.0, Hand::Right);
        check("10-24 UNC", "10-24 UNC", 0.19 * 25.4, 25.4 / 24.0, Hand::Right);
        check("1 1/8-7 UNC", "1 1/8-7 UNC", 1.125 * 25.4, 25.4 / 7.0, Hand::Right);
        check("1-1/8-7", "1-1/8-7", 1.125 * 25.4, 25.4 / 7.0, Hand::Right);
        check("1-8 UNC", "1-8 UNC", 25.4, 25.4 / 8.0, Hand::Right);
        check("0.250-20", "0.250-20", 6.35, 1.27, Hand::Right);
    }

    #[test]
    fn what_names_no_thread_is_refused_and_quoted() {
        for text in
            ["", "M", "M0", "M6x", "M6x0", "M6x7", "M5.5", "1/0-20", "G1/4", "1/4", "M6x1x2", "-20"]
        {
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

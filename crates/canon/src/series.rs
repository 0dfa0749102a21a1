//! Which standard thread a pitch and a diameter mean: a program that turns a thread states its lead
//! alone.
//!
//! Diameters by pitch: ISO 261, table 2 (choices 1 to 3, coarse and fine, up to 64 mm); UNC and UNF
//! of ASME B1.1.
use crate::thread::{COARSE_MM, UNIFIED};
use crate::{Family, Hand, ThreadSize};
use alloc::{format, string::String, vec::Vec};
use units::{Length, MM_PER_INCH};

/// Fine pitches of ISO 261 and the nominal diameters that have them, mm.
const FINE_MM: [(f64, &[f64]); 11] = [
    (0.2, &[1.0, 1.2, 1.4, 1.6, 1.8]),
    (0.25, &[2.0, 2.2]),
    (0.35, &[2.5, 3.0, 3.5]),
    (0.5, &[4.0, 4.5, 5.0, 5.5]),
    (0.75, &[6.0, 7.0, 8.0, 9.0, 10.0, 11.0]),
    (
        1.0,
        &[
            8.0, 9.0, 10.0, 11.0, 12.0, 14.0, 15.0, 16.0, 17.0, 18.0, 20.0, 22.0, 24.0, 25.0, 27.0,
            28.0, 30.0,
        ],
    ),
    (1.25, &[10.0, 12.0, 14.0]),
    (
        1.5,
        &[
            12.0, 14.0, 15.0, 16.0, 17.0, 18.0, 20.0, 22.0, 24.0, 25.0, 26.0, 27.0, 28.0, 30.0,
            32.0, 33.0, 35.0, 36.0, 38.0, 39.0, 40.0, 42.0, 45.0, 48.0, 50.0, 52.0, 55.0, 56.0,
            58.0, 60.0, 62.0, 64.0,
        ],
    ),
    (
        2.0,
        &[
            18.0, 20.0, 22.0, 24.0, 25.0, 27.0, 28.0, 30.0, 32.0, 33.0, 36.0, 39.0, 40.0, 42.0,
            45.0, 48.0, 50.0, 52.0, 55.0, 56.0, 58.0, 60.0, 62.0, 64.0,
        ],
    ),
    (
        3.0,
        &[
            30.0, 33.0, 36.0, 39.0, 40.0, 42.0, 45.0, 48.0, 50.0, 52.0, 55.0, 56.0, 58.0, 60.0,
            62.0, 64.0,
        ],
    ),
    (4.0, &[42.0, 45.0, 48.0, 52.0, 55.0, 56.0, 58.0, 60.0, 62.0, 64.0]),
];
/// Pitches closer than this share are one: a lead in inches with four decimals.
const SAME_PITCH: f64 = 5e-4;

/// All standard threads of a pitch, the metric ones first.
pub fn standard_sizes(pitch: Length, hand: Hand) -> Vec<ThreadSize> {
    let is = |mm: f64| (pitch.value() / mm - 1.0).abs() < SAME_PITCH;
    let coarse = COARSE_MM.iter().filter(|(_, p)| is(*p)).copied();
    let fine = FINE_MM.iter().filter(|(p, _)| is(*p));
    let fine = fine.flat_map(|(p, nominals)| nominals.iter().map(|d| (*d, *p)));
    let mut metric: Vec<_> = coarse.chain(fine).collect();
    metric.sort_by(|a, b| a.0.total_cmp(&b.0));
    metric.dedup();
    let metric =
        metric.into_iter().map(|(d, p)| ThreadSize::metric(Length::mm(d), Length::mm(p), hand));
    let unified = UNIFIED
        .iter()
        .flat_map(|(inches, coarse, fine)| [(*inches, *coarse, "UNC"), (*inches, *fine, "UNF")]);
    let unified = unified
        .filter(|(_, per_inch, _)| *per_inch > 0.0 && is(MM_PER_INCH / per_inch))
        .map(|(inches, per_inch, series)| ThreadSize {
            designation: format!("{}-{per_inch} {series}", in_inches(inches)),
            family: Family::Unified,
            nominal: Length::inch(inches),
            pitch: Length::inch(1.0 / per_inch),
            hand,
        });
    metric.chain(unified).collect()
}

/// "#10", "1/4", "1-1/8".
fn in_inches(inches: f64) -> String {
    if inches < 0.25 {
        return format!("#{}", libm::round((inches - 0.060) / 0.013));
    }
    let (whole, sixteenths) =
        (libm::floor(inches), libm::round((inches - libm::floor(inches)) * 16.0));
    if sixteenths == 0.0 {
        return format!("{whole}");
    }
    let mut fraction = (sixteenths as u32, 16_u32);
    while fraction.0.is_multiple_of(2) {
        fraction = (fraction.0 / 2, fraction.1 / 2);
    }
    let (top, bottom) = fraction;
    if whole == 0.0 { format!("{top}/{bottom}") } else { format!("{whole}-{top}/{bottom}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(pitch: Length) -> Vec<String> {
        standard_sizes(pitch, Hand::Right).into_iter().map(|size| size.designation).collect()
    }

    #[test]
    fn a_pitch_has_its_coarse_and_its_fine_sizes() {
        let sizes = named(Length::mm(1.5));
        assert_eq!(sizes[..3], ["M10x1.5", "M12x1.5", "M14x1.5"]);
        assert!(sizes.contains(&"M20x1.5".into()) && !sizes.contains(&"M19x1.5".into()));
        assert_eq!(named(Length::mm(3.1)), Vec::<String>::new());
    }

    #[test]
    fn inch_pitches_have_inch_sizes_that_are_read_back() {
        assert_eq!(named(Length::inch(1.0 / 13.0)), ["1/2-13 UNC"]);
        assert_eq!(named(Length::inch(0.05)), ["1/4-20 UNC", "7/16-20 UNF", "1/2-20 UNF"]);
        for size in standard_sizes(Length::inch(1.0 / 7.0), Hand::Right) {
            let read: ThreadSize = size.designation.parse().unwrap();
            assert!((read.nominal - size.nominal).abs() < Length::um(1.0), "{size:?}");
        }
    }
}

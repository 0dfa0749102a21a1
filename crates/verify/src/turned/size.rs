//! Which standard thread a turned thread is, and its limits of size.
//!
//! A program states the lead alone. The size is the standard one of that pitch (ISO 261, ASME B1.1)
//! whose diameter is the bar's, or whose minor diameter is the bore's. Of an external metric thread
//! the class asked is 6g, of ISO 965-1:
//!
//! ```text
//!   es = −(15 + 11·P) µm       Td = 180·P^⅔ − 3.15/√P µm       Td2 = 90·P^0.4·d^0.1 µm       rounded to R 40
//!
//!   major  d + es − Td … d + es         pitch  d2 + es − Td2 … d2 + es
//!   minor  d2min − H … d1 + es          the root from the sharp V to the Go gauge's crest
//! ```
//!
//! A root radius of at least P/8 is asked of fasteners of strength 8.8 and more only; it is the
//! insert's, and not judged.
//!
//! Of an external unified thread it is 2A of ASME B1.1: the allowance is 0.3·Td2 and Td = 0.06·P^⅔
//! in, Td2 as in [`crate::tolerance`]. Internal threads are 6H and 2B: [`Limits`].
use crate::class::ThreadClass;
use crate::insert::{Side, TRIANGLE};
use crate::tolerance::{Limits, preferred, step_mean_mm};
use canon::{Family, Hand, ThreadSize, standard_sizes};
use units::{Length, MM_PER_INCH};

/// Fundamental deviations of g and tolerances Td of grade 6, by pitch: mm and µm (ISO 965-1, tables
/// 1 and 4).
const TABLE: [(f64, f64, f64); 21] = [
    (0.35, 19.0, 85.0),
    (0.4, 19.0, 95.0),
    (0.45, 20.0, 100.0),
    (0.5, 20.0, 106.0),
    (0.6, 21.0, 125.0),
    (0.7, 22.0, 140.0),
    (0.75, 22.0, 140.0),
    (0.8, 24.0, 150.0),
    (1.0, 26.0, 180.0),
    (1.25, 28.0, 212.0),
    (1.5, 32.0, 236.0),
    (1.75, 34.0, 265.0),
    (2.0, 38.0, 280.0),
    (2.5, 42.0, 335.0),
    (3.0, 48.0, 375.0),
    (3.5, 53.0, 425.0),
    (4.0, 60.0, 475.0),
    (4.5, 63.0, 500.0),
    (5.0, 71.0, 530.0),
    (5.5, 75.0, 560.0),
    (6.0, 80.0, 600.0),
];
/// A bar may be so much larger or smaller than the nominal diameter, in pitches: a full profile
/// tops it, and it is turned down before.
const BAR: [f64; 2] = [0.25, 0.4];
/// Likewise a bore beyond or below the basic minor diameter.
const BORE: [f64; 2] = [0.4, 0.25];

/// Least and largest diameters of a thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnedLimits {
    /// Of the crest, or inside of the root, which has no largest.
    pub major: [Length; 2],
    /// Of the pitch cylinder.
    pub pitch: [Length; 2],
    /// Of the root, or inside of the crest.
    pub minor: [Length; 2],
}

/// What a thread is meant to be.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Size {
    pub(super) thread: ThreadSize,
    /// Its class, such as "6g".
    pub(super) class: &'static str,
    pub(super) limits: TurnedLimits,
}

impl Size {
    /// The standard thread of a pitch on a bar, or in a bore, of that diameter.
    pub(super) fn nearest(
        pitch: Length,
        hand: Hand,
        diameter: Length,
        side: Side,
        class: ThreadClass,
    ) -> Option<Self> {
        let [over, under] = if side == Side::External { BAR } else { BORE };
        let off = |size: &ThreadSize| {
            let basic = match side {
                Side::External => size.nominal,
                Side::Internal => size.minor_diameter(),
            };
            diameter - basic
        };
        let size = standard_sizes(pitch, hand)
            .into_iter()
            .filter(|size| (-pitch * under..=pitch * over).contains(&off(size)))
            .min_by(|a, b| off(a).abs().value().total_cmp(&off(b).abs().value()))?;
        let (class, limits) = match side {
            Side::External => external(&size),
            Side::Internal => internal(&size, class),
        };
        Some(Self { thread: size, class, limits })
    }
}

fn internal(size: &ThreadSize, class: ThreadClass) -> (&'static str, TurnedLimits) {
    let class = class.in_family(size.family);
    let limits = Limits::of(size, class);
    let from = |least: Length, width: Length| [least, least + width];
    let limits = TurnedLimits {
        major: [size.nominal, Length::mm(f64::INFINITY)],
        pitch: from(limits.pitch_diameter, limits.pitch_tolerance),
        minor: from(limits.minor_diameter, limits.minor_tolerance),
    };
    (class.name(), limits)
}

fn external(size: &ThreadSize) -> (&'static str, TurnedLimits) {
    let (class, deviation, major, pitch) = match size.family {
        Family::Metric => {
            let (deviation, major) = metric(size.pitch.value());
            let mean = step_mean_mm(size.nominal.value());
            let pitch = 90.0 * size.pitch.value().powf(0.4) * mean.powf(0.1);
            ("6g", Length::um(deviation), Length::um(major), Length::um(preferred(pitch)))
        }
        Family::Unified => {
            let (d, p) = (size.nominal.value() / MM_PER_INCH, size.pitch.value() / MM_PER_INCH);
            let pitch = 0.0015 * d.cbrt() + 0.0015 * d.sqrt() + 0.015 * p.powf(2.0 / 3.0);
            let major = 0.06 * p.powf(2.0 / 3.0);
            ("2A", Length::inch(0.3 * pitch), Length::inch(major), Length::inch(pitch))
        }
    };
    let below = |basic: Length, width: Length| [basic - deviation - width, basic - deviation];
    let pitch_limits = below(size.pitch_diameter(), pitch);
    let least_root = pitch_limits[0] - size.pitch * TRIANGLE;
    let limits = TurnedLimits {
        major: below(size.nominal, major),
        pitch: pitch_limits,
        minor: [least_root, size.minor_diameter() - deviation],
    };
    (class, limits)
}

/// Magnitude of es of g, and Td of grade 6, µm.
fn metric(pitch: f64) -> (f64, f64) {
    let listed = TABLE.iter().find(|(p, ..)| (p / pitch - 1.0).abs() < 1e-3);
    listed.map_or_else(
        || {
            let major = 180.0 * pitch.powf(2.0 / 3.0) - 3.15 / pitch.sqrt();
            (preferred(15.0 + 11.0 * pitch), preferred(major))
        },
        |(_, deviation, major)| (*deviation, *major),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> TurnedLimits {
        external(&text.parse().unwrap()).1
    }

    /// ISO 965-2: limits of 6g of the usual sizes, mm: major, pitch, and the minor diameter's most.
    const ISO: [(&str, [f64; 2], [f64; 2], f64); 7] = [
        ("M6x1", [5.794, 5.974], [5.212, 5.324], 4.891),
        ("M8x1.25", [7.760, 7.972], [7.042, 7.160], 6.619),
        ("M10x1.5", [9.732, 9.968], [8.862, 8.994], 8.344),
        ("M12x1.75", [11.701, 11.966], [10.679, 10.829], 10.072),
        ("M16x2", [15.682, 15.962], [14.503, 14.663], 13.797),
        ("M20x1.5", [19.732, 19.968], [18.854, 18.994], 18.344),
        ("M24x3", [23.577, 23.952], [21.803, 22.003], 20.704),
    ];

    #[test]
    fn external_limits_are_those_of_iso_965_2() {
        for (size, major, pitch, minor) in ISO {
            let found = of(size);
            for (found, listed) in
                found.major.iter().chain(&found.pitch).zip(major.iter().chain(&pitch))
            {
                assert!((found.value() - listed).abs() < 0.0011, "{size}: {found} for {listed}");
            }
            assert!((found.minor[1].value() - minor).abs() < 0.0011, "{size}: {:?}", found.minor);
        }
    }

    #[test]
    fn the_root_of_m20x1_5_is_at_least_the_sharp_v_of_its_least_pitch_diameter() {
        // 18.854 − √3/2·1.5
        assert!((of("M20x1.5").minor[0].value() - 17.555).abs() < 0.0015);
    }

    #[test]
    fn a_half_inch_bolt_has_the_limits_of_2a() {
        // ASME B1.1, table 2: 1/2-13 UNC-2A: major 0.4876 to 0.4985, pitch 0.4435 to 0.4485
        let found = of("1/2-13 UNC");
        let inch = |length: Length| length.value() / MM_PER_INCH;
        for (found, listed) in
            found.major.iter().chain(&found.pitch).zip([0.4876, 0.4985, 0.4435, 0.4485])
        {
            assert!((inch(*found) - listed).abs() < 0.00011, "{} for {listed}", inch(*found));
        }
    }

    #[test]
    fn the_size_is_the_standard_one_of_the_bar_or_of_the_bore() {
        let nearest = |pitch, diameter, side| {
            let [pitch, diameter] = [pitch, diameter].map(Length::mm);
            Size::nearest(pitch, Hand::Right, diameter, side, ThreadClass::H6)
                .map(|size| format!("{}-{}", size.thread.designation, size.class))
        };
        let said = |text: &str| Some(text.to_owned());
        assert_eq!(nearest(1.5, 20.0, Side::External), said("M20x1.5-6g"));
        assert_eq!(nearest(1.5, 19.85, Side::External), said("M20x1.5-6g"));
        assert_eq!(nearest(1.5, 18.5, Side::Internal), said("M20x1.5-6H"));
        assert_eq!(nearest(1.5, 19.0, Side::External), None, "M19x1.5 is no standard thread");
        assert_eq!(nearest(1.6, 20.0, Side::External), None);
        assert_eq!(nearest(25.4 / 13.0, 12.65, Side::External), said("1/2-13 UNC-2A"));
    }
}

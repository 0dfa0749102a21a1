//! How wide an internal thread may be: TD2 of its pitch diameter, TD1 of its minor diameter.
//!
//! ```text
//!              basic                                   class 6H: both zones begin at the basic size
//!   D2 ──────────┤▒▒▒▒▒▒▒ TD2 ▒▒▒▒▒▒▒├──────► pitch diameter
//!   D1 ──────────┤▒▒▒▒▒▒▒▒▒▒▒ TD1 ▒▒▒▒▒▒▒▒▒▒▒├──────► minor diameter
//! ```
//!
//! **Metric** (ISO 965-1): the table for the usual coarse sizes. For other sizes its formulas, with
//! d the geometric mean of the standard's diameter step, P and d in mm, rounded as the standard
//! does to the nearest preferred number of the series R 40. Of the table's 40 values of TD2 they
//! give 33 exactly and the others within one or two steps of the series (7.2 % at most):
//!
//! - Td2(6) = 90·P^0.4·d^0.1 µm;  TD2 = Td2(6) × 0.85 (4H), 1.06 (5H), 1.32 (6H), 1.7 (7H)
//! - TD1(6) = 433·P − 190·P^1.22 µm (P ≤ 0.8), 230·P^0.7 µm (P ≥ 1); × 0.63, 0.8, 1, 1.25
//!
//! **Unified** (ASME B1.1; D, P, Le in inches, Le = D for the coarse and fine series):
//!
//! - Td2(2A) = 0.0015·D^⅓ + 0.0015·Le^½ + 0.015·P^⅔;
//!   TD2 = Td2(2A) × 0.975 (3B), 1.3 (2B), 1.95 (1B)
//! - TD1(1B, 2B) = 0.25·P − 0.4·P² for D ≥ ¼ in (0.15·P under 4 threads per inch); below ¼ in
//!   0.05·P^⅔ + 0.03·P/D − 0.002, at least 0.25·P − 0.4·P² and at most 0.394·P
//! - TD1(3B) = 0.05·P^⅔ + 0.03·P/D − 0.002, at least 0.23·P − 1.5·P² (13 threads and finer) or
//!   0.120·P (coarser), at most 0.394·P
use crate::class::ThreadClass;
use canon::Family;
use canon::ThreadSize;
use units::{Length, MM_PER_INCH};

/// One size of ISO 965-1.
struct ToleranceRow {
    nominal_mm: f64,
    pitch_mm: f64,
    pitch_diameter_mm: f64,
    minor_diameter_mm: f64,
    /// TD2 of 4H, 5H, 6H, 7H.
    td2_um: [f64; 4],
    /// TD1 of 6H.
    td1_um: f64,
}

const fn row(size: [f64; 2], basic: [f64; 2], td2_um: [f64; 4], td1_um: f64) -> ToleranceRow {
    ToleranceRow {
        nominal_mm: size[0],
        pitch_mm: size[1],
        pitch_diameter_mm: basic[0],
        minor_diameter_mm: basic[1],
        td2_um,
        td1_um,
    }
}

/// Basic sizes of ISO 724, tolerances of ISO 965-1.
const TABLE: [ToleranceRow; 10] = [
    row([3.0, 0.5], [2.675, 2.459], [63.0, 80.0, 100.0, 125.0], 140.0),
    row([4.0, 0.7], [3.545, 3.242], [75.0, 95.0, 118.0, 150.0], 180.0),
    row([5.0, 0.8], [4.480, 4.134], [80.0, 100.0, 125.0, 160.0], 200.0),
    row([6.0, 1.0], [5.350, 4.917], [95.0, 118.0, 150.0, 190.0], 236.0),
    row([8.0, 1.25], [7.188, 6.647], [100.0, 125.0, 160.0, 200.0], 265.0),
    row([10.0, 1.5], [9.026, 8.376], [112.0, 140.0, 180.0, 224.0], 300.0),
    row([12.0, 1.75], [10.863, 10.106], [125.0, 160.0, 200.0, 250.0], 335.0),
    row([14.0, 2.0], [12.701, 11.835], [132.0, 170.0, 212.0, 265.0], 375.0),
    row([16.0, 2.0], [14.701, 13.835], [132.0, 170.0, 212.0, 265.0], 375.0),
    row([20.0, 2.5], [18.376, 17.294], [140.0, 180.0, 224.0, 280.0], 450.0),
];

/// Limits of the diameter steps of ISO 965-1, mm; a step excludes its lower and includes its upper
/// limit.
const STEPS_MM: [f64; 10] = [0.99, 1.4, 2.8, 5.6, 11.2, 22.4, 45.0, 90.0, 180.0, 355.0];

/// One decade of the preferred numbers R 40 (ISO 3), rounded as ISO 965-1 rounds them.
const R40: [f64; 41] = [
    1.0, 1.06, 1.12, 1.18, 1.25, 1.32, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9, 2.0, 2.12, 2.24, 2.36, 2.5,
    2.65, 2.8, 3.0, 3.15, 3.35, 3.55, 3.75, 4.0, 4.25, 4.5, 4.75, 5.0, 5.3, 5.6, 6.0, 6.3, 6.7,
    7.1, 7.5, 8.0, 8.5, 9.0, 9.5, 10.0,
];

/// Limits of size of an internal thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Basic pitch diameter D2: the Go gauge's.
    pub pitch_diameter: Length,
    /// TD2: above D2 by this much lies the No-go gauge.
    pub pitch_tolerance: Length,
    /// Basic minor diameter D1.
    pub minor_diameter: Length,
    /// TD1.
    pub minor_tolerance: Length,
}

impl Limits {
    /// Of a size in a class; a class of the other family is taken as its counterpart.
    pub fn of(size: &ThreadSize, class: ThreadClass) -> Self {
        let class = class.in_family(size.family);
        let (pitch_tolerance, minor_tolerance) = match size.family {
            Family::Metric => metric(size, class),
            Family::Unified => unified(size, class),
        };
        let listed = listed(size);
        Self {
            pitch_diameter: listed
                .map_or_else(|| size.pitch_diameter(), |row| Length::mm(row.pitch_diameter_mm)),
            pitch_tolerance,
            minor_diameter: listed
                .map_or_else(|| size.minor_diameter(), |row| Length::mm(row.minor_diameter_mm)),
            minor_tolerance,
        }
    }
}

/// Longest engagement for which the tolerances of a normal length ("N") hold:
/// 6.7·P·d^0.2 (ISO 965-1; d taken as the nominal diameter).
pub(crate) fn normal_engagement(size: &ThreadSize) -> Length {
    size.pitch * (6.7 * size.nominal.value().powf(0.2))
}

fn listed(size: &ThreadSize) -> Option<&'static ToleranceRow> {
    let (d, p) = (size.nominal.value(), size.pitch.value());
    let metric = size.family == Family::Metric;
    TABLE.iter().find(|row| metric && row.nominal_mm == d && row.pitch_mm == p)
}

/// Place of a metric class among 4H 5H 6H 7H.
fn grade(class: ThreadClass) -> usize {
    ThreadClass::of(Family::Metric).iter().position(|c| *c == class).unwrap_or(2) // `in_family` came before
}

/// TD2 and TD1 of a metric thread.
fn metric(size: &ThreadSize, class: ThreadClass) -> (Length, Length) {
    const TD1_FACTORS: [f64; 4] = [0.63, 0.8, 1.0, 1.25];
    let grade = grade(class);
    let (td2_um, td1_6_um) = match listed(size) {
        Some(row) => (row.td2_um[grade], row.td1_um),
        None => metric_by_formula(size, grade),
    };
    (Length::um(td2_um), Length::um(preferred(td1_6_um * TD1_FACTORS[grade])))
}

/// TD2 of the grade and TD1 of 6H by formula, µm.
fn metric_by_formula(size: &ThreadSize, grade: usize) -> (f64, f64) {
    const TD2_FACTORS: [f64; 4] = [0.85, 1.06, 1.32, 1.7];
    let p = size.pitch.value();
    let d = step_mean_mm(size.nominal.value());
    let td2_6_um = 90.0 * p.powf(0.4) * d.powf(0.1);
    let td1_um = if p < 0.9 { 433.0 * p - 190.0 * p.powf(1.22) } else { 230.0 * p.powf(0.7) };
    (preferred(td2_6_um * TD2_FACTORS[grade]), preferred(td1_um))
}

/// Geometric mean of the diameter step that holds `d_mm`.
pub(crate) fn step_mean_mm(d_mm: f64) -> f64 {
    STEPS_MM
        .windows(2)
        .find(|step| step[0] < d_mm && d_mm <= step[1])
        .map_or(d_mm, |step| (step[0] * step[1]).sqrt())
}

/// The nearest number of the series R 40.
pub(crate) fn preferred(value: f64) -> f64 {
    let decade = 10_f64.powf(value.log10().floor());
    let distance = |r: f64| (r * decade / value).ln().abs();
    R40.into_iter()
        .min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
        .map_or(value, |r| r * decade)
}

/// TD2 and TD1 of a unified thread.
fn unified(size: &ThreadSize, class: ThreadClass) -> (Length, Length) {
    let d = size.nominal.value() / MM_PER_INCH;
    let p = size.pitch.value() / MM_PER_INCH;
    let engagement = d;
    let td2_2a = 0.0015 * d.cbrt() + 0.0015 * engagement.sqrt() + 0.015 * p.powf(2.0 / 3.0);
    let fine = 0.05 * p.powf(2.0 / 3.0) + 0.03 * p / d - 0.002;
    let threads_per_inch = 1.0 / p;
    let ordinary = 0.25 * p - 0.4 * p * p;
    let td1_1b_2b = if threads_per_inch < 4.0 {
        0.15 * p
    } else if d < 0.25 - 1e-9 {
        fine.max(ordinary).min(0.394 * p)
    } else {
        ordinary
    };
    let least_3b = if threads_per_inch > 12.5 { 0.23 * p - 1.5 * p * p } else { 0.12 * p };
    let (td2, td1) = match class {
        ThreadClass::B3 => (td2_2a * 0.975, fine.max(least_3b).min(0.394 * p)),
        ThreadClass::B1 => (td2_2a * 1.95, td1_1b_2b),
        _ => (td2_2a * 1.3, td1_1b_2b),
    };
    (Length::inch(td2), Length::inch(td1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::Hand;

    fn limits(text: &str, class: ThreadClass) -> Limits {
        Limits::of(&text.parse().unwrap(), class)
    }

    /// ISO 965-1: size, D2, D1 (mm), TD2 of 4H 5H 6H 7H, TD1 of 6H (µm).
    type IsoRow = (&'static str, f64, f64, [f64; 4], f64);
    const ISO: [IsoRow; 10] = [
        ("M3x0.5", 2.675, 2.459, [63.0, 80.0, 100.0, 125.0], 140.0),
        ("M4x0.7", 3.545, 3.242, [75.0, 95.0, 118.0, 150.0], 180.0),
        ("M5x0.8", 4.480, 4.134, [80.0, 100.0, 125.0, 160.0], 200.0),
        ("M6x1", 5.350, 4.917, [95.0, 118.0, 150.0, 190.0], 236.0),
        ("M8x1.25", 7.188, 6.647, [100.0, 125.0, 160.0, 200.0], 265.0),
        ("M10x1.5", 9.026, 8.376, [112.0, 140.0, 180.0, 224.0], 300.0),
        ("M12x1.75", 10.863, 10.106, [125.0, 160.0, 200.0, 250.0], 335.0),
        ("M14x2", 12.701, 11.835, [132.0, 170.0, 212.0, 265.0], 375.0),
        ("M16x2", 14.701, 13.835, [132.0, 170.0, 212.0, 265.0], 375.0),
        ("M20x2.5", 18.376, 17.294, [140.0, 180.0, 224.0, 280.0], 450.0),
    ];

    #[test]
    fn every_listed_size_has_the_limits_of_iso_965_1() {
        for (text, d2, d1, td2_um, td1_um) in ISO {
            for (class, td2_um) in ThreadClass::of(Family::Metric).iter().zip(td2_um) {
                let found = limits(text, *class);
                assert_eq!(found.pitch_diameter, Length::mm(d2), "{text}");
                assert_eq!(found.minor_diameter, Length::mm(d1), "{text}");
                assert!((found.pitch_tolerance.in_um() - td2_um).abs() < 1e-9, "{text} {class}");
            }
            let td1 = limits(text, ThreadClass::H6).minor_tolerance.in_um();
            assert!((td1 - td1_um).abs() < 1e-9, "{text}: {td1}");
        }
    }

    #[test]
    fn basic_diameters_by_formula_agree_with_the_table_to_its_last_digit() {
        for (text, d2, d1, ..) in ISO {
            let size: ThreadSize = text.parse().unwrap();
            assert!((size.pitch_diameter().value() - d2).abs() < 0.0006, "{text}");
            assert!((size.minor_diameter().value() - d1).abs() < 0.0006, "{text}");
        }
    }

    #[test]
    fn the_formulas_give_most_of_the_table_exactly_and_the_rest_within_seven_percent() {
        let mut exact = 0;
        for (text, _, _, td2_um, td1_um) in ISO {
            let size: ThreadSize = text.parse().unwrap();
            for (grade, listed) in td2_um.into_iter().enumerate() {
                let (by_formula, td1) = metric_by_formula(&size, grade);
                assert!(
                    (by_formula / listed - 1.0).abs() < 0.072,
                    "{text}: {by_formula} for {listed}"
                );
                assert!((td1 / td1_um - 1.0).abs() < 0.065, "{text}: TD1 {td1} for {td1_um}");
                exact += usize::from((by_formula - listed).abs() < 0.5);
            }
        }
        assert_eq!(exact, 33, "of the table's 40 entries");
    }

    #[test]
    fn a_fine_thread_gets_its_tolerance_by_formula() {
        // ISO 965-1 lists M10x1: TD2 6H 150, TD1 6H 236; M8x1 the same.
        let m10x1 = limits("M10x1", ThreadClass::H6);
        assert!((m10x1.pitch_tolerance.in_um() - 150.0).abs() < 1.0, "{}", m10x1.pitch_tolerance);
        assert!((m10x1.minor_tolerance.in_um() / 236.0 - 1.0).abs() < 0.05);
    }

    #[test]
    fn inch_limits_are_those_of_asme_b1_1_table_2_within_rounding() {
        // size, class, pitch diameter min max, minor diameter min max; inches
        let listed = [
            ("1/4-20 UNC", ThreadClass::B2, 0.2175, 0.2224, 0.196, 0.207),
            ("1/4-20 UNC", ThreadClass::B3, 0.2175, 0.2211, 0.1960, 0.2067),
            ("1/4-20 UNC", ThreadClass::B1, 0.2175, 0.2248, 0.196, 0.207),
            ("5/16-18 UNC", ThreadClass::B2, 0.2764, 0.2817, 0.252, 0.265),
            ("3/8-16 UNC", ThreadClass::B2, 0.3344, 0.3401, 0.307, 0.321),
            ("1/2-13 UNC", ThreadClass::B2, 0.4500, 0.4565, 0.417, 0.434),
            ("#10-24 UNC", ThreadClass::B2, 0.1629, 0.1672, 0.145, 0.156),
            ("#8-32 UNC", ThreadClass::B2, 0.1437, 0.1475, 0.130, 0.139),
            ("#6-32 UNC", ThreadClass::B2, 0.1177, 0.1214, 0.104, 0.114),
            ("3/4-10 UNC", ThreadClass::B2, 0.6850, 0.6927, 0.642, 0.663),
            ("1-8 UNC", ThreadClass::B2, 0.9188, 0.9276, 0.865, 0.890),
            ("1 1/4-7 UNC", ThreadClass::B2, 1.1572, 1.1668, 1.095, 1.123),
            ("2-4.5 UNC", ThreadClass::B2, 1.8557, 1.8681, 1.759, 1.795),
        ];
        for (text, class, d2_min, d2_max, d1_min, d1_max) in listed {
            let found = limits(text, class);
            let inch = |length: Length| length.value() / MM_PER_INCH;
            let d2 = inch(found.pitch_diameter);
            let d1 = inch(found.minor_diameter);
            assert!((d2 - d2_min).abs() < 0.0001, "{text} D2 {d2}");
            assert!(
                (d2 + inch(found.pitch_tolerance) - d2_max).abs() < 0.0001,
                "{text} {class} TD2"
            );
            assert!((d1 - d1_min).abs() < 0.0006, "{text} D1 {d1}");
            let d1_top = d1 + inch(found.minor_tolerance);
            assert!((d1_top - d1_max).abs() < 0.0008, "{text} {class} TD1: {d1_top}");
        }
    }

    #[test]
    fn a_coarser_class_is_never_narrower() {
        for (nominal, pitch) in [(1.0, 0.25), (7.0, 1.0), (30.0, 3.5), (300.0, 6.0)] {
            let size = ThreadSize::metric(Length::mm(nominal), Length::mm(pitch), Hand::Right);
            let widths = ThreadClass::of(Family::Metric).iter().map(|c| Limits::of(&size, *c));
            let widths: Vec<_> = widths.collect();
            assert!(widths.windows(2).all(|w| w[0].pitch_tolerance < w[1].pitch_tolerance));
            assert!(widths.windows(2).all(|w| w[0].minor_tolerance < w[1].minor_tolerance));
        }
    }
}

//! Thread designations: what "M6" and "1/4-20 UNC" say in millimetres.
//!
//! ```text
//!   M 10 x 1.25 -LH        metric (ISO 261, 724): nominal diameter x pitch; without pitch: coarse
//!   1/4 - 20 UNC -LH       unified (ASME B1.1): nominal diameter in inches or #number, threads per inch
//!   #10 - 32               number size: 0.060 in + 0.013 in × number
//! ```
use units::{Lead, Length, MM_PER_INCH};

/// A single-start thread.
#[derive(Clone, Debug, PartialEq)]
pub struct Thread {
    /// As it is written, without the hand: "M6x1", "1/4-20 UNC".
    pub designation: String,
    /// Nominal (major) diameter.
    pub nominal: Length,
    /// Lead; negative for a left-hand thread.
    pub lead: Lead,
}

/// ISO 261 coarse pitch by nominal diameter, mm.
const COARSE: [(f64, f64); 31] = [
    (1.0, 0.25),
    (1.2, 0.25),
    (1.4, 0.3),
    (1.6, 0.35),
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
];

/// ASME B1.1 series by size: threads per inch, coarse and fine; 0 where there is none.
const UNIFIED: [(&str, u32, u32); 21] = [
    ("#0", 0, 80),
    ("#1", 64, 72),
    ("#2", 56, 64),
    ("#3", 48, 56),
    ("#4", 40, 48),
    ("#5", 40, 44),
    ("#6", 32, 40),
    ("#8", 32, 36),
    ("#10", 24, 32),
    ("#12", 24, 28),
    ("1/4", 20, 28),
    ("5/16", 18, 24),
    ("3/8", 16, 24),
    ("7/16", 14, 20),
    ("1/2", 13, 20),
    ("9/16", 12, 18),
    ("5/8", 11, 18),
    ("3/4", 10, 16),
    ("7/8", 9, 14),
    ("1", 8, 12),
    ("1-1/4", 7, 12),
];

impl Thread {
    /// Read a designation; `None` if it is none.
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        let upper = text.to_ascii_uppercase();
        let hand = upper.strip_suffix("LH").map(|t| t.trim_end_matches(['-', ' ']));
        let body = hand.unwrap_or(&upper);
        let mut thread = metric(body).or_else(|| unified(body))?;
        if hand.is_some() {
            thread.lead = -thread.lead;
        }
        Some(thread)
    }

    /// Pitch diameter of a tap of class ISO 2 (for 6H) over the basic one: the middle of its field, which
    /// reaches from 0.3 to 0.5 of TD2 of grade 5 (ISO 2857).
    pub fn tap_oversize(&self) -> Length {
        const MIDDLE: f64 = 0.4;
        Length::um(MIDDLE * self.pitch_tolerance_grade_5_um())
    }

    /// TD2(5) = 1.06·90·P^0.4·d^0.1 µm, d the geometric mean of the diameter step (ISO 965-1).
    fn pitch_tolerance_grade_5_um(&self) -> f64 {
        const STEPS_MM: [f64; 10] = [0.99, 1.4, 2.8, 5.6, 11.2, 22.4, 45.0, 90.0, 180.0, 355.0];
        let nominal = self.nominal.value();
        let within = STEPS_MM.windows(2).find(|step| nominal > step[0] && nominal <= step[1]);
        let mean = within.map_or(nominal, |step| (step[0] * step[1]).sqrt());
        1.06 * 90.0 * self.lead.value().abs().powf(0.4) * mean.powf(0.1)
    }
}

/// A plain decimal number: digits and at most one point.
fn decimal(text: &str) -> Option<f64> {
    let plain = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    text.parse::<f64>().ok().filter(|n| plain && n.is_finite() && *n > 0.0)
}

fn metric(text: &str) -> Option<Thread> {
    const LARGEST_MM: f64 = 600.0;
    let size = text.strip_prefix('M')?.trim_start();
    let (nominal, pitch) = if let Some((nominal, pitch)) = size.split_once('X') {
        (decimal(nominal.trim())?, decimal(pitch.trim())?)
    } else {
        let nominal = decimal(size)?;
        (nominal, COARSE.iter().find(|(d, _)| *d == nominal)?.1)
    };
    (nominal <= LARGEST_MM && pitch < nominal).then(|| Thread {
        designation: format!("M{nominal}x{pitch}"),
        nominal: Length::mm(nominal),
        lead: Lead::mm_per_rev(pitch),
    })
}

fn unified(text: &str) -> Option<Thread> {
    const MOST_PER_INCH: u32 = 200;
    let words = text.rsplit_once(' ');
    let (body, series) = match words {
        Some((body, series)) if series.starts_with("UN") => (body.trim_end(), Some(series)),
        _ => (text, None),
    };
    let (size, per_inch) = body.rsplit_once('-')?;
    let (size, per_inch) = (size.trim(), per_inch.trim().parse::<u32>().ok()?);
    let inches = inches(size)?;
    if per_inch == 0 || per_inch > MOST_PER_INCH || inches * f64::from(per_inch) <= 1.0 {
        return None;
    }
    // "10-32" is the number size #10
    let size =
        if size.parse::<u32>().is_ok_and(|n| n > 1) { format!("#{size}") } else { size.into() };
    let known = UNIFIED.iter().find(|(name, ..)| *name == size);
    let by_table = match known {
        Some((_, coarse, _)) if *coarse == per_inch => "UNC",
        Some((.., fine)) if *fine == per_inch => "UNF",
        _ => "UN",
    };
    let series = match series {
        // a coarse or fine thread that the standard does not have under that name is a slip
        Some(stated @ ("UNC" | "UNF")) if stated != by_table && known.is_some() => return None,
        Some(stated @ ("UN" | "UNC" | "UNF" | "UNEF" | "UNS")) => stated,
        Some(_) => return None,
        None => by_table,
    };
    Some(Thread {
        designation: format!("{size}-{per_inch} {series}"),
        nominal: Length::inch(inches),
        lead: Lead::mm_per_rev(MM_PER_INCH / f64::from(per_inch)),
    })
}

/// Nominal diameter of a unified size: "1/4", "1-1/4", "#10", "10", "0.25".
fn inches(size: &str) -> Option<f64> {
    const LARGEST_INCH: f64 = 24.0;
    let value = if let Some(number) = size.strip_prefix('#') {
        numbered(number.parse().ok()?)?
    } else if let Some((whole, fraction)) = size.split_once('-') {
        decimal(whole)? + fraction_of_inch(fraction)?
    } else if size.contains('/') {
        fraction_of_inch(size)?
    } else if let Ok(number @ 2..=12) = size.parse::<u32>() {
        numbered(number)?
    } else {
        decimal(size)?
    };
    (value <= LARGEST_INCH).then_some(value)
}

fn numbered(number: u32) -> Option<f64> {
    (number <= 14).then(|| 0.060 + 0.013 * f64::from(number))
}

fn fraction_of_inch(text: &str) -> Option<f64> {
    let (above, below) = text.split_once('/')?;
    Some(decimal(above)? / decimal(below)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (String, f64, f64) {
        let thread = Thread::parse(text).unwrap_or_else(|| panic!("{text}"));
        (thread.designation, thread.nominal.value(), thread.lead.value())
    }

    #[test]
    fn metric_threads_have_their_coarse_pitch_unless_another_is_stated() {
        assert_eq!(read("M6"), ("M6x1".into(), 6.0, 1.0));
        assert_eq!(read("m10x1.25"), ("M10x1.25".into(), 10.0, 1.25));
        assert_eq!(read("M 8 x 1.0"), ("M8x1".into(), 8.0, 1.0));
        assert_eq!(read("M2.5"), ("M2.5x0.45".into(), 2.5, 0.45));
    }

    #[test]
    fn a_left_hand_thread_has_a_negative_lead_and_the_same_name() {
        assert_eq!(read("M8x1.25-LH"), ("M8x1.25".into(), 8.0, -1.25));
        assert_eq!(read("1/4-20 UNC-LH"), ("1/4-20 UNC".into(), 6.35, -1.27));
        assert_eq!(read("M6 LH"), ("M6x1".into(), 6.0, -1.0));
    }

    #[test]
    fn unified_threads_are_named_by_their_series() {
        assert_eq!(read("1/4-20"), ("1/4-20 UNC".into(), 6.35, 1.27));
        assert_eq!(read("1/4-28").0, "1/4-28 UNF");
        assert_eq!(read("10-32"), ("#10-32 UNF".into(), 0.19 * 25.4, 25.4 / 32.0));
        assert_eq!(read("1-1/4-7 UNC"), ("1-1/4-7 UNC".into(), 31.75, 25.4 / 7.0));
        assert_eq!(read("1/4-32 UNEF").0, "1/4-32 UNEF");
    }

    #[test]
    fn what_is_no_thread_or_contradicts_its_series_is_refused() {
        for text in [
            "",
            "M",
            "M6x6",
            "M6x0",
            "M6xNaN",
            "Minf",
            "1/4-28 UNC",
            "1/0-20",
            "6 mm",
            "M9",
            "x",
            "-LH",
            "1/4-0",
        ] {
            assert_eq!(Thread::parse(text), None, "{text}");
        }
    }

    #[test]
    fn the_usual_oversize_of_m6_is_two_fifths_of_118_um() {
        // TD2 5H of M6 is 118 µm by ISO 965-1's table
        let oversize = Thread::parse("M6").unwrap().tap_oversize().in_um();
        assert!((oversize - 0.4 * 118.0).abs() < 1.0, "{oversize}");
    }
}

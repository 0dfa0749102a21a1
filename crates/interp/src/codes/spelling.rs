//! Codes and letters as people write them, and what they perhaps meant.
use crate::codes::{Code, G_CODES, GGroup, M_CODES, MGroup, OWN};

/// A code's number as it is written: 331 is 33.1.
#[derive(Clone, Copy)]
pub(crate) struct Written(u16);

impl core::fmt::Display for Written {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (whole, tenth) = (self.0 % OWN / 10, self.0 % 10);
        match tenth {
            0 => write!(f, "{whole}"),
            tenth => write!(f, "{whole}.{tenth}"),
        }
    }
}

/// A number as people write it: what counting in binary leaves behind the sixth decimal goes.
pub(crate) fn short(value: f64) -> f64 {
    let rounded = (value * 1e6).round() / 1e6 + 0.0; // no minus zero
    if rounded.is_finite() { rounded } else { value }
}

/// A code as people write it.
pub(crate) const fn written(tenths: u16) -> Written {
    Written(tenths)
}

/// What an unknown G number was perhaps meant to be.
pub(crate) fn similar_g(value: f64) -> String {
    let digits = |text: &str| text.chars().filter(char::is_ascii_digit).collect::<String>();
    let found = digits(&format!("{value}"));
    let same = |c: &&Code<GGroup>| {
        c.supported
            && (digits(&written(c.tenths).to_string()) == found
                || f64::from(c.tenths / 10) == value.trunc())
    };
    let names: Vec<_> = G_CODES
        .iter()
        .filter(same)
        .map(|c| format!("G{} ({})", written(c.tenths), c.name))
        .collect();
    if names.is_empty() { String::new() } else { format!("did you mean {}?", names.join(" or ")) }
}

/// What an unknown M number was perhaps meant to be: a digit typed twice, left out, or exchanged
/// with its neighbour.
pub(crate) fn similar_m(value: f64) -> String {
    let written = format!("{value}");
    let sorted = |text: &str| {
        let mut digits: Vec<_> = text.bytes().filter(u8::is_ascii_digit).collect();
        digits.sort_unstable();
        digits
    };
    let found = sorted(&written);
    let near = |code: &&Code<MGroup>| {
        let number = (code.tenths / 10).to_string();
        let exchanged = sorted(&number) == found;
        let twice = written.len() == number.len() + 1
            && (0..written.len()).any(|i| {
                let mut shorter = written.clone();
                shorter.remove(i);
                shorter == number
            });
        code.group != MGroup::User && (exchanged || twice && written.starts_with(&number[..1]))
    };
    let names: Vec<_> = M_CODES
        .iter()
        .filter(near)
        .take(3)
        .map(|c| format!("M{} ({})", c.tenths / 10, c.name))
        .collect();
    if names.is_empty() { String::new() } else { format!("did you mean {}?", names.join(" or ")) }
}

/// The codes that take a letter, as one phrase.
pub(crate) fn takers(letter_index: usize) -> String {
    let bit = 1 << letter_index;
    let g = G_CODES.iter().filter(|c| c.supported && c.letters & bit != 0);
    let m = M_CODES.iter().filter(|c| c.supported && c.letters & bit != 0);
    let all: Vec<_> = (g.map(|c| format!("G{}", written(c.tenths))))
        .chain(m.map(|c| format!("M{}", written(c.tenths))))
        .collect();
    match all.len() {
        0 => "no code takes it".to_owned(),
        _ => format!("it belongs to {}", all.join(", ")),
    }
}

/// What a G code is to other controls that hobby CAM writes for, as Mach3, and what stands for it
/// here.
pub(crate) fn of_others(value: f64) -> Option<(&'static str, &'static str)> {
    Some(match crate::codes::number::tenths(value)? {
        310 => (
            "the probing move of Mach3, Fanuc and Haas",
            "G38.2 is the probing move here, and #5061 to #5063 are where it ended",
        ),
        120 | 130 => ("a circular pocket of Mach3 and Haas", "G2 or G3 mills a circle"),
        150 | 160 => {
            ("polar coordinates of Mach3 and Fanuc", "@ and ^ are a radius and an angle here")
        }
        510 => ("scaling of Mach3 and Fanuc", "write the numbers as they are meant"),
        680 | 690 => ("a rotation of Mach3 and Fanuc", "G10 L2 R turns the work offset"),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_point_is_guessed() {
        assert_eq!(similar_g(331.0), "did you mean G33.1 (rigid tapping)?");
        assert_eq!(similar_g(12.3), "");
        assert_eq!(similar_m(33.0), "did you mean M3 (spindle clockwise)?");
        assert_eq!(similar_m(91.0), "did you mean M9 (coolant off) or M19 (orient the spindle)?");
        assert_eq!(similar_m(77.0), "did you mean M7 (mist coolant on)?");
    }

    #[test]
    fn a_number_is_written_without_what_counting_in_binary_leaves() {
        let written = |value: f64| short(value).to_string();
        assert_eq!(written(2.0 / 3.0), "0.666667");
        assert_eq!(written(300.1 - 0.3 + 0.6), "300.4");
        assert_eq!((written(-1e-9), written(1e300)), ("0".into(), 1e300.to_string()));
    }
}

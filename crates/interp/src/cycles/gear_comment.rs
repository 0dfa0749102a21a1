//! `(GEAR …)`: what the drawing asks of the gear that the next G81 T L Q P hobs.
//!
//! ```text
//!   (GEAR SHIFT 0.3 WIDTH 20 TIP 90.33 SPAN -0.02 -0.08 ANGLE 20 GRADE 7)
//! ```
//!
//! | word | asks | else |
//! |---|---|---|
//! | SHIFT | coefficient of the profile shift | 0 |
//! | WIDTH | width of the toothed face | not judged |
//! | TIP | diameter over the tips | a module over the shifted reference circle |
//! | SPAN | allowances of the span W, the upper and the lower one | the usual tolerance, each way |
//! | ANGLE | pressure angle, degrees | 20 |
//! | GRADE | grade of ISO 1328-1 | 7 |
//!
//! Lengths are in the unit in force. A comment holds until the next one.
use crate::{call::Units, modes::Modes};
use canon::GearAsked;
use diag::{Diagnostic, Span};
use units::{Angle, Length, MM_PER_INCH};

const WORDS: &str = "SHIFT, WIDTH, TIP, SPAN, ANGLE and GRADE are understood";
/// Bounds of the numbers; lengths in mm.
const SHIFT: f64 = 3.0;
const LONGEST_MM: f64 = 10_000.0;
const SPAN_MM: f64 = 5.0;
const ANGLE_DEG: (f64, f64) = (5.0, 45.0);
const GRADES: (f64, f64) = (1.0, 11.0);

/// Takes what a comment states of a gear; another comment is passed over.
pub(crate) fn gear_comment(
    text: &str,
    span: Span,
    modes: &mut Modes,
    remarks: &mut Vec<Diagnostic>,
) {
    let text = text.trim();
    if !text.get(..4).is_some_and(|word| word.eq_ignore_ascii_case("GEAR")) {
        return;
    }
    let words: Vec<&str> = text[4..].split_whitespace().collect();
    let known = ["SHIFT", "WIDTH", "TIP", "SPAN", "ANGLE", "GRADE"];
    let is_known = |word: &&str| known.iter().any(|k| word.eq_ignore_ascii_case(k));
    // "(gear for the pump)" is for people
    if !text[4..].starts_with(char::is_whitespace) || !words.iter().any(is_known) {
        return;
    }
    let mm = if modes.units == Units::Inch { MM_PER_INCH } else { 1.0 };
    match asked(&words, mm) {
        Ok(asked) => modes.gear = asked,
        Err(wrong) => {
            let message = format!("(GEAR …): {wrong}");
            remarks.push(Diagnostic::warning("I0824", span, message).with_help(WORDS));
        }
    }
}

fn asked(words: &[&str], mm: f64) -> Result<GearAsked, String> {
    let mut found = GearAsked::default();
    let mut rest = words.iter();
    let bound = |name: &str, value: f64, from: f64, to: f64| {
        let wrong = || format!("expected {name} from {from} to {to}, found {value}");
        (from..=to).contains(&value).then_some(value).ok_or_else(wrong)
    };
    while let Some(name) = rest.next() {
        let name = name.to_ascii_uppercase();
        let mut number = || {
            let word = rest.next().ok_or_else(|| format!("{name} has no number"))?;
            let value = word.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| format!("{name} has \"{word}\", which is no number"))
        };
        let value = match name.as_str() {
            "SHIFT" | "WIDTH" | "TIP" | "SPAN" | "ANGLE" | "GRADE" => number()?,
            _ => return Err(format!("\"{name}\" is not understood")),
        };
        let length = |value: f64| bound(&name, value * mm, 1e-3, LONGEST_MM).map(Length::mm);
        match name.as_str() {
            "SHIFT" => found.shift = bound(&name, value, -SHIFT, SHIFT)?,
            "WIDTH" => found.width = Some(length(value)?),
            "TIP" => found.tip_diameter = Some(length(value)?),
            "ANGLE" => {
                let degrees = bound(&name, value, ANGLE_DEG.0, ANGLE_DEG.1)?;
                found.pressure_angle = Some(Angle::deg(degrees));
            }
            "GRADE" => {
                let grade = bound(&name, value, GRADES.0, GRADES.1)?;
                found.grade = Some(grade.round() as u8);
            }
            _ => {
                let ends = [value, number()?].map(|end| bound(&name, end * mm, -SPAN_MM, SPAN_MM));
                let [a, b] = ends;
                let (a, b) = (a?, b?);
                if a == b {
                    return Err("SPAN has the same allowance twice".to_owned());
                }
                found.span = Some([a.max(b), a.min(b)].map(Length::mm));
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<GearAsked, String> {
        asked(&text.split_whitespace().collect::<Vec<_>>(), 1.0)
    }

    #[test]
    fn a_drawings_table_is_understood_in_any_order() {
        let found = of("GRADE 6 SHIFT 0.3 WIDTH 20 TIP 90.33 SPAN -0.08 -0.02 ANGLE 25").unwrap();
        assert_eq!((found.shift, found.grade), (0.3, Some(6)));
        assert_eq!(found.span, Some([-0.02, -0.08].map(Length::mm)));
        assert_eq!(found.width, Some(Length::mm(20.0)));
        assert!((found.pressure_angle().in_deg() - 25.0).abs() < 1e-9);
        let inches = asked(&["WIDTH", "1"], MM_PER_INCH).unwrap();
        assert_eq!(inches.width, Some(Length::mm(25.4)));
    }

    #[test]
    fn what_is_not_understood_is_said() {
        for (text, said) in [
            ("SHIFT", "SHIFT has no number"),
            ("SHIFT x", "\"x\", which is no number"),
            ("SHIFT 9", "expected SHIFT from -3 to 3, found 9"),
            ("SPAN -0.02", "SPAN has no number"),
            ("SHIFT 0.3 CROWN 2", "\"CROWN\" is not understood"),
        ] {
            let wrong = of(text).unwrap_err();
            assert!(wrong.contains(said), "{text}: {wrong}");
        }
    }
}

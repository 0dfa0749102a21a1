//! Values of requests: axes by their letters, coordinates in the unit of their axis, percents, work
//! offsets.
use canon::Axis;
use control::operation::hosted::{RefusalData, RefusalKind};
use store::machine::MachineFile;
use units::{AxisKind, Coordinate};

/// A line of the control's text as clients see it: paths without the folder of programs.
pub(crate) type Shown<'a> = &'a dyn Fn(&str) -> String;

/// The request cannot be what was meant.
pub(super) fn wrong(reason: String) -> RefusalData {
    RefusalData { kind: RefusalKind::Request, reason, remedy: None, findings: Vec::new() }
}

/// An axis and a coordinate of it, which is named in mm of a linear axis and in degrees of a rotary
/// one.
pub(super) fn of_axis(
    letter: &str,
    machine: &MachineFile,
    (name_mm, mm, name_deg, deg): (&str, Option<f64>, &str, Option<f64>),
) -> Result<(Axis, Coordinate), RefusalData> {
    let axis = axis_named(letter, machine)?;
    let (moves, name, value, other_name, other) = match axis.kind() {
        AxisKind::Linear => ("is linear", name_mm, mm, name_deg, deg),
        AxisKind::Rotary => ("is rotary", name_deg, deg, name_mm, mm),
    };
    let letter = axis.letter();
    match (value, other) {
        (Some(value), None) => Ok((axis, Coordinate::new(value))),
        (None, None) => Err(wrong(format!("axis {letter} {moves}: \"{name}\" is missing"))),
        (_, Some(_)) => {
            Err(wrong(format!("axis {letter} {moves}: \"{name}\", not \"{other_name}\"")))
        }
    }
}

/// The axis of a letter.
pub(super) fn axis_named(text: &str, machine: &MachineFile) -> Result<Axis, RefusalData> {
    let mut letters = text.chars();
    let found = match (letters.next(), letters.next()) {
        (Some(letter), None) => Axis::from_letter(letter.to_ascii_uppercase()),
        _ => None,
    };
    found.filter(|axis| machine.axis(*axis).is_some()).ok_or_else(|| {
        let has: Vec<String> =
            machine.axes.iter().flatten().map(|axis| axis.letter.letter().to_string()).collect();
        wrong(format!(
            "there is no axis \"{}\": {} has {}",
            short(text),
            machine.name,
            has.join(", ")
        ))
    })
}

/// Of what a client has sent, no more than is read.
fn short(text: &str) -> String {
    text.chars().take(40).collect()
}

/// A share of one from percents within a range.
pub(super) fn share(what: &str, percent: f64, least: f64, most: f64) -> Result<f64, RefusalData> {
    let share = percent / 100.0;
    if (least..=most).contains(&share) {
        return Ok(share);
    }
    let (least, most) = (least * 100.0, most * 100.0);
    Err(wrong(format!("the {what} goes from {least:.0} to {most:.0} percent, found {percent}")))
}

/// `G54` to `G59`, `G59.1` to `G59.3`: 1 to 9.
pub(super) fn system(name: &str) -> Result<u8, RefusalData> {
    let number = match name.to_ascii_uppercase().as_str() {
        "G54" => 1,
        "G55" => 2,
        "G56" => 3,
        "G57" => 4,
        "G58" => 5,
        "G59" => 6,
        "G59.1" => 7,
        "G59.2" => 8,
        "G59.3" => 9,
        _ => {
            return Err(wrong(format!(
                "work offsets are G54 to G59 and G59.1 to G59.3, found \"{}\"",
                short(name)
            )));
        }
    };
    Ok(number)
}

//! Listings of canonical calls in LinuxCNC's notation, ours and theirs, made comparable.
//!
//! ```text
//!    12 N10    STRAIGHT_FEED(1.0000, -0.0000, …)   ─►   STRAIGHT_FEED(1.0000, 0.0000, …)
//! ```
//!
//! The counter and the N field go, and minus zero becomes zero: what is left is what the machine
//! is told. Lines that are no calls (what a program prints itself) are left out.

use canon::{Tool, ToolKind, ToolLibrary};
use interp::{Interpreter, Listing, Setup};
use units::Length;

/// Tools that both interpreters are given: number n is 0.1·n inch long and 0.01·n inch wide.
const TOOLS: u32 = 64;

/// What an interpreter made of a program.
pub(crate) enum Outcome {
    /// Its calls, comparable.
    Accepted(Vec<String>),
    /// Its first complaint.
    Refused(String),
}

/// The comparable calls of a listing.
pub(crate) fn calls(listing: &str) -> Vec<String> {
    listing.lines().filter_map(call).collect()
}

fn call(line: &str) -> Option<String> {
    let (counter, rest) = line.trim_start().split_once(' ')?;
    let (number, call) = rest.split_once(' ')?;
    let counted = counter.bytes().all(|b| b.is_ascii_digit());
    (counted && number.starts_with('N')).then(|| positive_zeros(call.trim()))
}

/// The line with `-0.0000` written `0.0000`, in all places.
pub(crate) fn positive_zeros(line: &str) -> String {
    line.replace("-0.000000", "0.000000")
        .replace("-0.0000)", "0.0000)")
        .replace("-0.0000,", "0.0000,")
        .replace("-0.0000 ", "0.0000 ")
}

/// What Leadscrew's interpreter makes of a program.
pub(crate) fn ours(program: &[u8], tools: ToolLibrary) -> Outcome {
    let setup = Setup { tools, stand_alone: true, ..Setup::default() };
    let mut interpreter = Interpreter::new(program, &setup);
    let mut listing = Listing::new(Vec::new());
    interpreter.run(&mut listing);
    if let Some(error) = interpreter.diagnostics().iter().find(|d| d.is_error()) {
        return Outcome::Refused(format!(
            "{} line {}: {}",
            error.code, error.span.line, error.message
        ));
    }
    match listing.finish() {
        Ok(bytes) => Outcome::Accepted(calls(&String::from_utf8_lossy(&bytes))),
        Err(error) => Outcome::Refused(error.to_string()),
    }
}

/// The tools, for Leadscrew.
pub(crate) fn tools() -> ToolLibrary {
    ToolLibrary::new((1..=TOOLS).map(|number| Tool {
        number,
        pocket: number,
        length: Length::mm(2.54 * f64::from(number)),
        diameter: Length::mm(0.254 * f64::from(number)),
        kind: ToolKind::Other,
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    }))
}

/// The same tools, in LinuxCNC's notation; without an INI file its table is in inches.
pub(crate) fn tool_table() -> String {
    let line =
        |n: u32| format!("T{n} P{n} Z{:.1} D{:.2}\n", f64::from(n) / 10.0, f64::from(n) / 100.0);
    (1..=TOOLS).map(line).collect()
}

/// The first place where two listings differ: line number, theirs, ours.
pub(crate) fn first_difference(
    theirs: &[String],
    ours: &[String],
) -> Option<(usize, String, String)> {
    let end = "(the end)".to_owned();
    (0..theirs.len().max(ours.len())).find_map(|i| {
        let (a, b) = (theirs.get(i).unwrap_or(&end), ours.get(i).unwrap_or(&end));
        (a != b).then(|| (i + 1, a.clone(), b.clone()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counter_n_field_and_minus_zero_do_not_count() {
        let theirs = "   12 N10    STRAIGHT_FEED(-0.0000, 1.0000, -0.0000)\nhello\n";
        let ours = "    3 N..... STRAIGHT_FEED(0.0000, 1.0000, 0.0000)\n";
        assert_eq!(calls(theirs), calls(ours));
        assert_eq!(first_difference(&calls(theirs), &calls(ours)), None);
    }

    #[test]
    fn small_negative_numbers_stay() {
        assert_eq!(positive_zeros("A(-0.00001, -0.0000, -0.0005)"), "A(-0.00001, 0.0000, -0.0005)");
    }

    #[test]
    fn a_listing_that_ends_early_differs_there() {
        let lines = |n: usize| vec!["X()".to_owned(); n];
        assert_eq!(
            first_difference(&lines(3), &lines(2)),
            Some((3, "X()".into(), "(the end)".into()))
        );
    }
}

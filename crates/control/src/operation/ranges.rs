//! The range of each number that a request has, by the machine's file: what no machine of this file
//! can mean is refused before anything else is asked, with the range that works. What a control has
//! kept is held to the same when it is read.
//!
//! | number | from | to |
//! |---|---|---|
//! | jog to | beginning of the travel | its end |
//! | jog by, handwheel | − the length of the travel | + the same |
//! | speed of a jog | − rapid | + rapid |
//! | zero of a work offset | one travel before its beginning | one travel behind its end |
//! | tip's coordinate at a touch off | what makes such a zero from anywhere in the travel | |
//! | speed of a spindle | − its fastest | + its fastest |
//! | angle of a spindle | −360° | 360° |
//! | overrides | as the file says | |
use super::control::Control;
use super::offsets::{SYSTEMS, name, parameter};
use super::request::{Jog, Refusal, Request};
use crate::Refused;
use crate::job::restart::From;
use canon::Axis;
use core::ops::RangeInclusive;
use std::path::Path;
use store::machine::{Axis as AxisFile, MachineFile};
use units::{AxisKind, Coordinate};

/// Most holes or threads that a tool is limited to.
const MOST_USES: u32 = 10_000_000;
/// Levels of block skip.
const LEVELS: RangeInclusive<f64> = 1.0..=9.0;
/// What a tool's length adds to a touch off, mm.
const LONGEST_TOOL: f64 = super::offsets::LONGEST;

impl Control {
    /// Refuses a request with a number out of its range, or whose needs are not met.
    ///
    /// # Errors
    /// The first of them.
    pub(super) fn admits(&self, request: &Request) -> Result<(), Refusal> {
        check(request, &self.base.machine)?;
        request.needs().iter().try_for_each(|need| self.meets(need).map_err(Refusal::State))
    }
}

/// Refuses a request that has a number out of its range.
///
/// # Errors
/// It has one; the sentence names the range.
pub(super) fn check(request: &Request, machine: &MachineFile) -> Result<(), Refused> {
    let overrides = &machine.control.overrides;
    match request {
        Request::Jog(axis, jog) => check_jog(*axis, *jog, machine),
        Request::TurnSpindle(spindle, spin) => match machine.spindles.get(*spindle) {
            Some(file) => {
                let most = file.max.in_rpm();
                let what = format!("the speed of spindle {spindle}");
                within(&what, spin.in_rpm(), -most..=most, " rev/min")
            }
            None => Ok(()), // there is none: that is refused where it is looked for
        },
        Request::OrientSpindle(_, angle) => {
            within("the angle of a spindle", angle.in_deg(), -360.0..=360.0, "°")
        }
        Request::Search(From::Line(number), _) => counted("the line of a search", *number),
        Request::Search(From::Hole(number), _) => counted("the hole of a search", *number),
        Request::BlockSkip(level, _) => within("the level of /", f64::from(*level), LEVELS, ""),
        Request::FeedOverride(share) => {
            percent("the feed override", *share, 0.0..=overrides.feed_most_share)
        }
        Request::RapidOverride(share) => percent("the rapid override", *share, 0.0..=1.0),
        Request::SpindleOverride(share) => {
            let range = overrides.spindle_least_share..=overrides.spindle_most_share;
            percent("the spindle override", *share, range)
        }
        Request::TouchOff(axis, at) => of_axis(*axis, machine, |file| {
            let zero = zero(file);
            let tool = if file.letter == Axis::Z { LONGEST_TOOL } else { 0.0 };
            let from = file.travel.from.value() - tool - zero.end();
            let to = file.travel.to.value() + tool - zero.start();
            (format!("{} at a touch off", axis.letter()), *at, from..=to)
        }),
        Request::SetWorkOffset(system, axis, at) => of_axis(*axis, machine, |file| {
            (format!("the zero of {} along {}", name(*system), axis.letter()), *at, zero(file))
        }),
        Request::LimitTool(_, Some(uses)) => {
            within("the uses of a tool", f64::from(*uses), 1.0..=f64::from(MOST_USES), "")
        }
        // a tool's number is one of the table, its measures have the ranges of tools
        Request::EditTool(..)
        | Request::RenewTool(_)
        | Request::LimitTool(_, None)
        | Request::Search(From::Tool(_), _)
        // no numbers
        | Request::Power(_)
        | Request::EmergencyStop(_)
        | Request::Home(_)
        | Request::JogStop
        | Request::Load(_)
        | Request::LoadAs(..)
        | Request::Start
        | Request::ManualDataInput(_)
        | Request::FeedHold
        | Request::Resume
        | Request::Confirm
        | Request::Stop
        | Request::Retract
        | Request::Recover
        | Request::ToolIsFree
        | Request::Sequence(_)
        | Request::AcknowledgeState
        | Request::BeginWorkpiece(_)
        | Request::EndWorkpiece
        | Request::Reset
        | Request::SingleBlock(_)
        | Request::OptionalStop(_)
        | Request::Flood(_)
        | Request::Mist(_) => Ok(()),
    }
}

/// Work offsets that no request could have set: their parameters, and a sentence of each.
pub(super) fn out_of_range(
    parameters: &interp::Parameters,
    machine: &MachineFile,
) -> Vec<(usize, Refused)> {
    let mut found = Vec::new();
    for file in machine.axes.iter().flatten() {
        for system in 1..=SYSTEMS {
            let number = parameter(system, file.letter);
            let value = parameters.get(number).unwrap_or(0.0);
            let (name, letter) = (name(system), file.letter.letter());
            let what = format!("parameter {number}, the zero of {name} along {letter},");
            if let Err(why) = within(&what, value, zero(file), file.letter.kind().unit()) {
                found.push((number, why));
            }
        }
    }
    found
}

/// Refuses what a control finds when it begins if a work offset is in it that it could not have
/// set.
///
/// # Errors
/// There is one; the sentence names it, its range and the file.
pub(super) fn check_kept(
    parameters: &interp::Parameters,
    machine: &MachineFile,
    state: Option<&Path>,
) -> Result<(), Refused> {
    let Some((_, why)) = out_of_range(parameters, machine).into_iter().next() else {
        return Ok(());
    };
    let Some(folder) = state else { return Err(why) };
    let file = folder.join("parameters.var");
    let file = file.display();
    Err(Refused::because(format!(
        "{file}: {why}: write the right one, and the word edited for the checksum in its first line"
    )))
}

/// Where the zero of a work offset may be: a fixture stands in the travel or near it.
pub(super) fn zero(file: &AxisFile) -> RangeInclusive<f64> {
    let (from, to) = (file.travel.from.value(), file.travel.to.value());
    let beyond = match file.letter.kind() {
        AxisKind::Linear => to - from,
        AxisKind::Rotary => (to - from).max(360.0),
    };
    // a file that says nothing has its zero at the machine's own
    (from - beyond).min(0.0)..=(to + beyond).max(0.0)
}

fn check_jog(axis: Axis, jog: Jog, machine: &MachineFile) -> Result<(), Refused> {
    of_axis(axis, machine, |file| {
        let (from, to) = (file.travel.from.value(), file.travel.to.value());
        let (way, letter) = (to - from, axis.letter());
        match jog {
            Jog::To(place) => (format!("a jog of {letter}"), place, from..=to),
            Jog::Increment(by) | Jog::Handwheel(by) => {
                (format!("a jog of {letter}"), by, -way..=way)
            }
            Jog::Continuous(speed) => {
                let (per_min, most) = (speed.in_per_min(), file.rapid.in_per_min());
                let speed = Coordinate::new(per_min);
                (format!("the speed of {letter} per minute"), speed, -most..=most)
            }
        }
    })
}

/// Of an axis that the machine has; of another one it is refused where it is looked for.
fn of_axis(
    axis: Axis,
    machine: &MachineFile,
    number: impl Fn(&AxisFile) -> (String, Coordinate, RangeInclusive<f64>),
) -> Result<(), Refused> {
    machine.axis(axis).map_or(Ok(()), |file| {
        let (what, value, range) = number(file);
        within(&what, value.value(), range, axis.kind().unit())
    })
}

/// Lines and holes are counted from one.
fn counted(what: &str, number: u32) -> Result<(), Refused> {
    within(what, f64::from(number), 1.0..=f64::from(u32::MAX), "")
}

fn percent(what: &str, share: f64, range: RangeInclusive<f64>) -> Result<(), Refused> {
    within(what, share * 100.0, range.start() * 100.0..=range.end() * 100.0, " percent")
}

fn within(what: &str, value: f64, range: RangeInclusive<f64>, unit: &str) -> Result<(), Refused> {
    if range.contains(&value) {
        return Ok(());
    }
    let (from, to) = (range.start(), range.end());
    Err(Refused::because(format!(
        "{what} goes from {from:.3}{unit} to {to:.3}{unit}, found {}{unit}",
        shown(value)
    )))
}

/// Returns a number as a person writes it; one that no machine has, by its power of ten.
fn shown(value: f64) -> String {
    if value.abs() < 1e9 { ((value * 1e4).round() / 1e4).to_string() } else { format!("{value:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use units::{Angle, CoordinateSpeed, Spin};

    fn machine() -> MachineFile {
        crate::config::machine_file::load("mill-5-axis").expect("it is right")
    }

    /// Requests with one number, by that.
    fn by_number(axis: Axis, n: f64) -> Vec<Request> {
        let at = Coordinate::new(n);
        vec![
            Request::Jog(axis, Jog::To(at)),
            Request::Jog(axis, Jog::Increment(at)),
            Request::Jog(axis, Jog::Handwheel(at)),
            Request::Jog(axis, Jog::Continuous(CoordinateSpeed::new(n))),
            Request::TouchOff(axis, at),
            Request::SetWorkOffset(3, axis, at),
            Request::TurnSpindle(0, Spin::rpm(n)),
            Request::OrientSpindle(0, Angle::deg(n)),
            Request::FeedOverride(n),
            Request::RapidOverride(n),
            Request::SpindleOverride(n),
        ]
    }

    #[test]
    fn a_number_that_no_machine_has_is_refused_with_the_range_that_works() {
        let machine = machine();
        for axis in machine.axes.iter().flatten() {
            for n in [1e300, -1e300, 1e9, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
                for request in by_number(axis.letter, n) {
                    let refused = check(&request, &machine).expect_err("out of all ranges");
                    let why = refused.to_string();
                    assert!(why.contains("goes from") && why.contains("found"), "{why}");
                }
            }
        }
    }

    #[test]
    fn the_ends_of_each_range_are_in_it_and_what_is_beyond_is_not() {
        let machine = machine();
        for file in machine.axes.iter().flatten() {
            let axis = file.letter;
            let (zero, travel) = (zero(file), (file.travel.from.value(), file.travel.to.value()));
            let set =
                |n: f64| check(&Request::SetWorkOffset(1, axis, Coordinate::new(n)), &machine);
            let go = |n: f64| check(&Request::Jog(axis, Jog::To(Coordinate::new(n))), &machine);
            for (works, fails) in [
                (set(*zero.start()), set(zero.start() - 1e-6)),
                (set(*zero.end()), set(zero.end() + 1e-6)),
                (go(travel.0), go(travel.0 - 1e-6)),
                (go(travel.1), go(travel.1 + 1e-6)),
            ] {
                assert!(works.is_ok() && fails.is_err(), "{axis:?}");
            }
        }
        for (level, is_in) in [(0, false), (1, true), (9, true), (10, false)] {
            assert_eq!(check(&Request::BlockSkip(level, true), &machine).is_ok(), is_in, "{level}");
        }
        for (uses, is_in) in [(0, false), (1, true), (MOST_USES, true), (u32::MAX, false)] {
            let limit = Request::LimitTool(1, Some(uses));
            assert_eq!(check(&limit, &machine).is_ok(), is_in, "{uses}");
        }
        assert!(check(&Request::Search(From::Line(0), false), &machine).is_err());
    }

    #[test]
    fn every_machine_of_ours_has_its_own_work_offset_in_range() {
        for name in store::machine::EMBEDDED {
            let machine = crate::config::machine_file::load(name).expect("right");
            for file in machine.axes.iter().flatten() {
                let at = machine.setup.g54.along(file.letter).value();
                assert!(zero(file).contains(&at), "{name} {:?}: {at}", file.letter);
            }
        }
    }

    #[test]
    fn kept_parameters_are_held_to_the_same() {
        let machine = machine();
        let mut parameters = interp::Parameters::default();
        assert!(check_kept(&parameters, &machine, None).is_ok());
        assert!(parameters.set(parameter(9, Axis::Y), 1e9));
        let why = check_kept(&parameters, &machine, Some(Path::new("out"))).expect_err("nowhere");
        let why = why.to_string();
        for part in ["out/parameters.var", "5382", "G59.3 along Y", "1e9"] {
            assert!(why.contains(part), "{why}");
        }
    }
}

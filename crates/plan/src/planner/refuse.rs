//! Moves that a machine cannot make: coordinates, feeds and arcs, judged before anything is planned
//! from them.
//!
//! Every refusal names what was found, what the machine can do, and the number that would work.
use super::{Job, Planner};
use crate::along::{Along, change};
use crate::findings::{Cause, number};
use crate::travel::{Beyond, beyond};
use crate::words::{
    Rounding, WHICH_UNIT, advice, advised, bare_length, feed, feed_that_works, instead, is_rotary,
    length, modal, place, word,
};
use alloc::{format, string::String, vec, vec::Vec};
use canon::{Arc, Axis, Feed, LengthUnit, Position, ProgramFrame};
use diag::{Diagnostic, Span};
use motion::{Path, Profile, coordinate, radius};
use units::Spin;

/// Coordinates beyond this are a mistake on any machine: a kilometre.
const ABSURD: f64 = 1e6;

/// Longest time that one block may take, s: a day.
const LONGEST: f64 = 86_400.0;

impl Planner {
    /// Of paths one after another, which make up one move.
    pub(super) fn is_refused(&mut self, job: &Job, paths: &[Path]) -> bool {
        let wild = paths.iter().find_map(|path| wild(path.to()));
        if let (Some((axis, x)), [first, ..]) = (wild, paths) {
            let text = format!(
                "expected a coordinate within ±{ABSURD} mm, found {} {}",
                axis.letter(),
                number(x)
            );
            self.findings.add(Diagnostic::error("M0302", job.span, text));
            // go on from a place that exists
            self.programmed = *first.from();
            return true;
        }
        let mut refused = false;
        let all: Vec<_> = beyond(paths, &self.limits).collect();
        // the ends of others are not all that decides how far they reach
        let is_straight = paths.iter().all(|path| matches!(path, Path::Line { .. }));
        for out in all {
            refused = true;
            // an axis that rests where a move before has left it is not this one's
            let rests =
                paths.first().is_some_and(|path| coordinate(path.from(), out.axis) == out.reaches);
            let said = self.beyond_at[out.axis.index()].replace(out.reaches);
            if !(rests && said == Some(out.reaches)) {
                self.beyond_travel(job.span, &out, is_straight);
            }
        }
        refused
    }

    /// An axis that leaves its travel, in the program's words; all moves beyond one end are one
    /// finding.
    fn beyond_travel(&mut self, span: Span, out: &Beyond, is_straight: bool) {
        let (axis, frame) = (out.axis, self.frame);
        let is_high = out.reaches > out.travel.1;
        let tool = if axis == Axis::Z { self.tool } else { 0 };
        let which =
            [(axis.index() * 2) as u32 + u32::from(is_high), u32::from(frame.work_offset), tool];
        let by = (out.reaches - out.nearest()).abs();
        let unit_help = is_of_other_unit(&frame, out);
        self.findings.merge(Cause { code: "M0301", which }, by, || {
            let is_written =
                frame.work_offset_code().is_some() && frame.written(axis, out.reaches).is_some();
            let (by, travel) = if is_written && !is_rotary(axis) {
                let travel = [out.travel.0, out.travel.1].map(|at| word(&frame, axis, at));
                (length(&frame, by), format!("{} to {}", travel[0], travel[1]))
            } else {
                in_machine_coordinates(&frame, axis, by, out.travel)
            };
            let wrong = format!(
                "{} would go to {}, {by} beyond its travel of {travel}",
                axis.letter(),
                place(&frame, axis, out.reaches),
            );
            let rounding = if is_high { Rounding::Down } else { Rounding::Up };
            let nearest = advice(&frame, axis, out.nearest(), rounding);
            let works = format!(": {nearest} is the nearest that works");
            let help = match axis {
                _ if unit_help => WHICH_UNIT,
                Axis::Z => {
                    "shift the work offset, raise or lower the work, or take a tool of another length"
                }
                _ => "shift the work offset or the work",
            };
            let finding = Diagnostic::error("M0301", span, "").with_help(help);
            let nearest = advised(&frame, axis, out.nearest(), rounding);
            let found = advised(&frame, axis, out.reaches, Rounding::Nearest);
            let words = vec![instead(nearest, found)];
            (if is_straight { finding.with_remedy(words) } else { finding }, [wrong, works])
        });
    }

    pub(super) fn feed_is_refused(&mut self, job: &Job, feed: Feed, turning: Spin) -> bool {
        let (value, what) = match feed {
            Feed::PerTime(speed) => (speed.value(), "a feed above zero (F)"),
            Feed::PerRevolution(lead) => {
                (lead.value(), "a feed per revolution above zero (F with G95)")
            }
            Feed::Duration(time) => (time.value(), "a duration above zero (F with G93)"),
        };
        if !(value > 0.0 && value.is_finite()) {
            let text = format!("expected {what}, found {}", number(value));
            self.findings.add(Diagnostic::error("M0303", job.span, text));
            return true;
        }
        if turning > Spin::ZERO {
            self.judge_tool_is_there(job);
            return false;
        }
        if let Feed::PerRevolution(_) = feed {
            let text = "a feed per revolution (G95) with the spindle at rest would never move: order M3 or M4 with an \
                        S above zero first";
            self.findings.add(Diagnostic::error("M0306", job.span, text));
            return true;
        }
        if !self.warned_still && !self.spindles.is_empty() {
            self.warned_still = true;
            let text = "cutting feed with the spindle at rest";
            let finding = Diagnostic::warning("M0307", job.span, text);
            self.findings
                .add(finding.with_help("order M3 or M4 with an S above zero before the first cut"));
        }
        false
    }

    /// A profile that moves nothing (limits of zero, or numbers out of all range) or lasts too
    /// long; its time is in units of which `per_second` pass in a second.
    pub(super) fn profile_is_refused(
        &mut self,
        job: &Job,
        profile: &Profile,
        per_second: f64,
    ) -> bool {
        let seconds = profile.duration() / per_second;
        self.time_is_refused(job, if seconds > 0.0 { seconds } else { f64::INFINITY })
    }

    /// A move that goes nowhere (limits of zero, or numbers out of all range) or lasts too long.
    pub(super) fn motion_is_refused(
        &mut self,
        job: &Job,
        bound: &Along,
        length: f64,
        wanted: f64,
    ) -> bool {
        let moves = bound.speed > 0.0 && bound.accel > 0.0 && bound.jerk > 0.0;
        let seconds = length / wanted.min(bound.speed);
        self.time_is_refused(job, if moves { seconds } else { f64::INFINITY })
    }

    /// Nothing that one block orders lasts for days: a decimal point is missing somewhere.
    pub(super) fn time_is_refused(&mut self, job: &Job, seconds: f64) -> bool {
        let endless = seconds.is_nan() || seconds > LONGEST;
        if endless {
            let text =
                format!("expected at most {LONGEST} s for one block, found {} s", number(seconds));
            let help = "give a higher feed, speed or lead, or a shorter dwell";
            self.findings.add(Diagnostic::error("M0314", job.span, text).with_help(help));
        }
        endless
    }

    pub(super) fn arc_is_sound(&mut self, job: &Job, to: &Position, arc: &Arc) -> bool {
        let from = self.programmed;
        let (r, end) = (radius(&from, arc), radius(to, arc));
        // as RS-274/NGC's interpreters allow, generously: what the interpreter let pass is not
        // refused here
        let sound = arc.sweep.is_finite() && r > 0.0 && (end - r).abs() <= 0.5_f64.max(0.01 * r);
        if !sound {
            let text = format!(
                "expected an arc whose start and end are equally far from its centre, found radii of {} and {}",
                bare_length(&self.frame, r),
                length(&self.frame, end),
            );
            self.findings.add(Diagnostic::error("M0311", job.span, text));
        }
        sound
    }
}

/// Whether a coordinate in inches would be within the travel if its number were meant in
/// millimetres.
fn is_of_other_unit(frame: &ProgramFrame, out: &Beyond) -> bool {
    let Some(written) = frame.written(out.axis, out.reaches) else { return false };
    let zero = out.reaches - written * frame.unit.in_mm();
    let meant = zero + written;
    frame.unit == LengthUnit::Inch
        && !is_rotary(out.axis)
        && (out.travel.0..=out.travel.1).contains(&meant)
}

/// A coordinate that no machine has.
pub(super) fn wild(position: &Position) -> Option<(Axis, f64)> {
    let absurd = |axis: Axis, x: f64| !x.is_finite() || (x.abs() > ABSURD && !is_rotary(axis));
    Axis::ALL
        .into_iter()
        .map(|axis| (axis, coordinate(position, axis)))
        .find(|(axis, x)| absurd(*axis, *x))
}

/// A warning that a feed is not reached; per second, along a path.
pub(super) fn clipped(
    span: Span,
    path: &Path,
    (wanted, possible): (f64, f64),
    frame: &ProgramFrame,
) -> Diagnostic {
    let (from, to) = (path.from(), path.to());
    let turns_only = matches!(path, Path::Line { .. })
        && Axis::ALL.into_iter().all(|axis| is_rotary(axis) || change(from, to, axis) == 0.0);
    let (asked, works) = if turns_only {
        let whole = number(libm::floor(possible * 60.0 + 1e-6));
        (format!("{} degrees a minute", number(wanted * 60.0)), whole)
    } else {
        (feed(frame, wanted * 60.0), feed_that_works(frame, possible * 60.0))
    };
    let text = format!(
        "a feed of {asked} is faster than the axes can along this path: it runs at {works}"
    );
    let is_inches = frame.unit == LengthUnit::Inch && wanted / units::MM_PER_INCH <= possible;
    let words = modal([('F', works.clone(), "G94")]);

    let help = if is_inches && !turns_only {
        "said once; G20 is in force: if F was meant in mm/min, write G21"
    } else {
        "said once; later moves may be slowed down likewise"
    };
    Diagnostic::warning("M0304", span, text).with_help(help).with_remedy(words)
}

/// A length and a travel along an axis, in machine coordinates.
fn in_machine_coordinates(
    frame: &ProgramFrame,
    axis: Axis,
    by: f64,
    travel: (f64, f64),
) -> (String, String) {
    if is_rotary(axis) {
        let unit = axis.kind().unit();
        let travel = format!("{} to {}{unit}", number(travel.0), number(travel.1));
        return (format!("{}{unit}", number(by)), travel);
    }
    let unit = frame.unit.symbol();
    let travel =
        format!("{} to {} {unit}", bare_length(frame, travel.0), bare_length(frame, travel.1));
    (length(frame, by), travel)
}

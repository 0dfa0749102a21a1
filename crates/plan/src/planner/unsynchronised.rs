//! Taps whose feed only goes as fast as the spindle should turn: a holder takes the difference.
//!
//! ```text
//!   clutch holder                                floating (tension/compression) holder
//!   1, 2  rapids to R, by ops before             rapids to R
//!   3  feed at S·H to Z + D, spindle forward     feed at S·H to Z, spindle forward
//!   4  dwell e: the tap pulls itself in by D     spindle stopped and awaited: it coasts, the tap runs on
//!   5  spindle reversed, dwell e from the order  dwell P; spindle reversed
//!   6  feed back to R                            feed back to R at once
//!   7  rapid back; spindle forward again         rapid back; spindle forward again
//! ```
//!
//! With the clutch, the depth is where the feed stops plus D, whatever the spindle does meanwhile;
//! without it, the tap runs deeper by H·n·(delay + `t_stop`/2), and as that scatters, so does the
//! depth.
use super::tap::Means;
use super::{Job, Planner};
use crate::StepKind;
use crate::clutch::{ClutchCycle, DwellWindow};
use crate::findings::number;
use crate::limits::{DwellCheck, PlainDrive, SpindleLimits};
use crate::tap_check::whole_rpm;
use crate::way_out;
use crate::words::length;
use alloc::format;
use canon::{Holder, Tap};
use diag::Diagnostic;
use motion::{Move, Path, Phase, Profile};
use units::{Angle, Coordinate, Length, Spin, Time};

/// Within which a drive that makes its own ramp is told a new speed, s.
const TOLD_WITHIN: f64 = 1e-3;

/// One way of the feed.
struct FeedStroke {
    path: Path,
    profile: Profile,
    /// How far it lags behind a feed that starts at once.
    lag: Length,
}

/// A clutch holder's own numbers.
#[derive(Clone, Copy)]
pub(super) struct Clutch {
    pub(super) spline_length: Length,
    pub(super) pawl_backlash: Angle,
}

impl Planner {
    /// Step 3 to 6 with a clutch holder.
    pub(super) fn clutch_tap(&mut self, job: &mut Job, tap: &Tap, means: &Means, clutch: Clutch) {
        if self.words_are_refused(job, tap) {
            return;
        }
        let start = tap.start.along(tap.axis).of_linear();
        let stroke = tap.bottom - start;
        let depth = (tap.bottom - tap.surface).abs();
        // a turn of the thread, by which the tap can pull itself in
        let least = clutch.spline_length + Length::mm(tap.lead.abs().value());
        if depth < least {
            let text = format!(
                "the clutch holder pulls the tap in by {} after the feed has stopped, and the thread is {} deep: the tap has \
                 not cut a turn by then, {} or more works",
                length(&self.frame, clutch.spline_length.value()),
                length(&self.frame, depth.value()),
                length(&self.frame, least.value()),
            );
            self.findings.add(Diagnostic::error("M0341", job.span, text));
            return;
        }
        let inward = if stroke < Length::ZERO { -1.0 } else { 1.0 };
        let stop = tap.bottom - clutch.spline_length * inward;
        let Some((there, back)) = self.ways(job, tap, stop) else { return };
        let cycle = ClutchCycle {
            spline_length: clutch.spline_length,
            pawl_backlash: clutch.pawl_backlash,
            lead: tap.lead.abs(),
            spin: tap.spin,
            clearance: ((tap.surface - start) * inward).max(Length::ZERO),
            reversal: self.reversal(&means.turning, tap.spin),
            feed_lag: back.lag,
        };
        let window = cycle.window();
        let dwell = if tap.dwell > Time::ZERO { tap.dwell } else { window.middle() };
        if self.dwell_is_refused(job, &cycle, &window, dwell) {
            return;
        }
        let spin = tap.spin * if tap.lead.value() < 0.0 { -1.0 } else { 1.0 };
        self.turn_and_await(job, spin);
        self.goes_in(job, tap);
        self.feed(job, &there, false);
        self.hand_on(job, StepKind::Dwell(dwell));
        self.turn_now(job, -spin);
        self.hand_on(job, StepKind::Dwell(dwell));
        self.feed(job, &back, true);
        self.hand_on(job, StepKind::WayOut(None));
        self.reversed_along = Some(tap.axis);
    }

    /// The conventional cycle: all the way down, stop, reverse.
    pub(super) fn floating_tap(&mut self, job: &mut Job, tap: &Tap, means: &Means, holder: Holder) {
        if self.words_are_refused(job, tap) {
            return;
        }
        let Some((there, back)) = self.ways(job, tap, tap.bottom) else { return };
        if self.holder_is_too_short(job, tap, means, holder) {
            return;
        }
        let spin = tap.spin * if tap.lead.value() < 0.0 { -1.0 } else { 1.0 };
        self.turn_and_await(job, spin);
        self.goes_in(job, tap);
        self.feed(job, &there, false);
        self.turn_now(job, Spin::ZERO);
        self.await_spindles(job);
        if tap.dwell > Time::ZERO {
            self.hand_on(job, StepKind::Dwell(tap.dwell));
        }
        self.turn_now(job, -spin);
        self.feed(job, &back, true);
        self.hand_on(job, StepKind::WayOut(None));
        self.reversed_along = Some(tap.axis);
    }

    /// From here on the tool is in the work: what comes after a control that has died must know.
    fn goes_in(&mut self, job: &mut Job, tap: &Tap) {
        let start = tap.start.along(tap.axis).of_linear();
        let outward = if tap.bottom < start { 1.0 } else { -1.0 };
        let way_out = way_out::floating(0, tap.axis, start, outward);
        self.hand_on(job, StepKind::WayOut(Some(way_out)));
    }

    /// Pecks and a return of another speed need a synchronised spindle.
    fn words_are_refused(&mut self, job: &Job, tap: &Tap) -> bool {
        let words = [
            (tap.peck.is_some(), "pecks (Q)"),
            (tap.return_spin != tap.spin, "a return speed (J)"),
            (
                tap.return_acceleration != canon::ReturnAcceleration::AsSet,
                "a return acceleration (I)",
            ),
        ];
        let mut refused = false;
        for (stated, what) in words {
            if stated {
                refused = true;
                let text = format!(
                    "{what} need a tap that is synchronised with the spindle; this one is not: leave the word out, or take \
                     a rigid holder and `--tapping synchronised`"
                );
                self.findings.add(Diagnostic::error("M0343", job.span, text));
            }
        }
        refused
    }

    /// Down to a coordinate at S·H and back; `None` if the axis cannot.
    fn ways(&mut self, job: &Job, tap: &Tap, to: Length) -> Option<(FeedStroke, FeedStroke)> {
        let (from, to) = (tap.start, tap.start.with(tap.axis, Coordinate::linear(to)));
        let feed = (tap.lead.abs() * tap.spin).value();
        let mut way = |from, to| {
            let path = Path::Line { from, to };
            let profile = self.bound(job, &path, false, feed)?.profile(path.length(), feed);
            if self.profile_is_refused(job, &profile, 1.0) {
                return None;
            }
            let lag = Length::mm((feed * profile.duration() - path.length()) / 2.0);
            Some(FeedStroke { path, profile, lag })
        };
        Some((way(from, to)?, way(to, from)?))
    }

    /// A dwell outside the window; told in any case, refused unless the user wants only to be
    /// warned.
    fn dwell_is_refused(
        &mut self,
        job: &Job,
        cycle: &ClutchCycle,
        window: &DwellWindow,
        dwell: Time,
    ) -> bool {
        if window.holds(dwell) {
            return false;
        }
        let left = cycle.slide_left(dwell);
        let because = if left < Length::ZERO {
            let beyond = length(&self.frame, -left.value());
            format!("the holder would be driven {beyond} beyond its home")
        } else if left > cycle.clearance {
            format!(
                "the tap would still be {} in its thread at the R plane, and the rapid back pulls it out",
                length(&self.frame, (left - cycle.clearance).value())
            )
        } else {
            "the splines would not have parted, and the spindle's coasting would go into the depth"
                .into()
        };
        let text = if window.least > window.most {
            format!(
                "no dwell works for this clutch holder at S{}: {because}; raise the R plane or lower S",
                number(cycle.spin.in_rpm())
            )
        } else {
            format!(
                "expected a dwell of {} to {} s for this clutch holder, found P{}: {because}; P{} works",
                ceil_ms(window.least),
                floor_ms(window.most),
                number(dwell.value()),
                number(window.middle().value()),
            )
        };
        match self.options.taps.dwell {
            DwellCheck::Refuse => {
                self.findings.add(Diagnostic::error("M0340", job.span, text));
                true
            }
            DwellCheck::Warn => {
                self.findings.add(Diagnostic::warning("M0340", job.span, text));
                false
            }
        }
    }

    /// How far a floating holder is pulled out at a speed: coasting down, and running up while the
    /// feed goes at once.
    fn pulled_out(&self, limits: &SpindleLimits, tap: &Tap, spin: Spin) -> Length {
        let stop = self.ramp_of(limits, spin, Spin::ZERO);
        let start = self.ramp_of(limits, Spin::ZERO, -spin);
        let coasted = Angle::rev(stop.turned_rev) + spin * stop.delay;
        let missed = spin * (start.time + start.delay) - Angle::rev(start.turned_rev);
        tap.lead.abs() * (coasted + missed)
    }

    fn holder_is_too_short(&mut self, job: &Job, tap: &Tap, means: &Means, holder: Holder) -> bool {
        let travel = match holder {
            Holder::SoftSynchro { travel, .. } | Holder::TensionCompression { travel, .. } => {
                travel
            }
            Holder::Rigid { .. } | Holder::Clutch { .. } => Length::ZERO,
        };
        let needed = self.pulled_out(&means.turning, tap, tap.spin);
        if needed <= travel {
            return false;
        }
        let (mut low, mut high) = (0.0, tap.spin.value());
        for _ in 0..53 {
            let middle = f64::midpoint(low, high);
            let fits = self.pulled_out(&means.turning, tap, Spin::rev_per_s(middle)) <= travel;
            if fits { low = middle } else { high = middle }
        }
        let works = whole_rpm(Spin::rev_per_s(low));
        let remedy = if works >= 1.0 {
            format!("S{works} works, or a holder with that travel")
        } else {
            "a tension/compression holder with that travel is needed".into()
        };
        let text = format!(
            "a tap that is not synchronised pulls its holder out by {} at S{}, and this one gives {}: {remedy}",
            length(&self.frame, needed.value()),
            number(tap.spin.in_rpm()),
            length(&self.frame, travel.value()),
        );
        self.findings.add(Diagnostic::error("M0342", job.span, text));
        true
    }

    /// What a reversal costs at full speed: the dwell less the revolutions turned back over the
    /// speed.
    fn reversal(&self, limits: &SpindleLimits, spin: Spin) -> Time {
        let stop = self.ramp_of(limits, spin, Spin::ZERO);
        let start = self.ramp_of(limits, Spin::ZERO, spin);
        stop.delay + stop.time + start.time - Angle::rev(start.turned_rev) / spin
    }

    /// A change of speed as spindle and drive make it.
    fn ramp_of(&self, limits: &SpindleLimits, from: Spin, to: Spin) -> Ramp {
        match self.options.taps.drive {
            None => {
                let ramp = limits.ramp(from, to);
                let (time, turned_rev) = (Time::s(ramp.duration()), ramp.end().s.abs());
                Ramp { delay: Time::ZERO, time, turned_rev }
            }
            Some(PlainDrive { delay, accel }) => {
                let time: Time = (to - from).abs() / accel;
                let turned_rev = ((from + to).abs() * time).value() / 2.0;
                Ramp { delay, time, turned_rev }
            }
        }
    }

    /// The ramp that a spindle is told: planned, or a step for a drive that makes its own.
    pub(super) fn told_ramp(&self, limits: &SpindleLimits, from: Spin, to: Spin) -> Profile {
        if self.options.taps.drive.is_none() {
            return limits.ramp(from, to);
        }
        let (v, change) = (from.value(), (to - from).value());
        let step = Phase { duration: TOLD_WITHIN, s: 0.0, v, a: change / TOLD_WITHIN, j: 0.0 };
        let mut profile = Profile::EMPTY;
        // cannot fail: it is the first piece
        let fits = profile.push(step);
        debug_assert!(fits);
        profile
    }

    fn turn_and_await(&mut self, job: &mut Job, spin: Spin) {
        self.turn_now(job, spin);
        self.await_spindles(job);
    }

    fn turn_now(&mut self, job: &mut Job, spin: Spin) {
        let steps = self.turn(job, 0, spin);
        self.outbox.release(steps, &self.limits, job.emit);
    }

    fn feed(&mut self, job: &mut Job, way: &FeedStroke, exact_stop: bool) {
        let FeedStroke { path, profile, .. } = *way;
        let cut = Move {
            path,
            profile,
            rapid: false,
            per_revolution: false,
            exact_stop,
            floats: true,
            programmed: None,
        };
        self.hand_on(job, StepKind::Move(cut.into()));
    }
}

/// From the order to the new speed.
struct Ramp {
    /// Until anything happens.
    delay: Time,
    /// From then on.
    time: Time,
    /// Revolutions in that time, rev.
    turned_rev: f64,
}

/// Rounded up to a millisecond, so that it still works.
fn ceil_ms(time: Time) -> f64 {
    libm::ceil(time.value() * 1e3 - 1e-6) / 1e3
}

/// Rounded down to a millisecond.
fn floor_ms(time: Time) -> f64 {
    libm::floor(time.value() * 1e3 + 1e-6) / 1e3
}

//! A tap: judged, then planned as two strokes, or as two strokes for each peck.
//!
//! ```text
//!   spindle at rest ─► [in: N rev, rest to rest] ─► dwell ─► [out: N rev, rest to rest] ─► at rest
//!
//!   Q, out in full        Q, chip broken
//!   R ●╮ ╭●╮ ╭●           R ●╮              ╭●     every stroke lies on one helix: that of the
//!      │ │ │ │               ╰╮             │      start angle at R. A peck begins where the one
//!   q  ╰─╯ │ │            q   ╰╮╭╮          │      before ended, at the angle the helix has there.
//!      2q  ╰─╯               2q ╰╯╰─────────╯
//! ```
//!
//! | canon::Tap | TapPlan |
//! |---|---|
//! | lead along the tap's own direction, + right-hand | axis travel per +1 rev: that times the direction of the stroke |
//! | speeds without sign | + clockwise: a right-hand tap goes in with + and out with − |
use super::refuse::wild;
use super::unsynchronised::Clutch;
use super::{Job, Planner};
use crate::StepKind;
use crate::along::change;
use crate::findings::number;
use crate::holes::Drilled;
use crate::limits::{AxisLimits, Retract, SpindleLimits, TapMethod};
use crate::stroke::{Stroke, StrokeRequest};
use crate::tap_check::{TapCheck, cutting_torque, torque_limit, whole_rpm};
use crate::words::{is_rotary, length};
use alloc::{format, string::String};
use canon::{Axis, Holder, ProgramFrame, ReturnAcceleration, Tap, TapTool, Tool, ToolKind};
use diag::{Diagnostic, Span};
use motion::TapPlan;
use units::{Angle, Coordinate, Lead, Length, Spin, SpinAccel, Time, Torque};

/// The axes stand at the start if they are this near to it, mm.
const AT_START: f64 = 1e-6;

/// The fastest way out that spindle and axis can tap.
fn highest_return(tap: &Tap, means: &Means) -> Spin {
    let (axis, spindle) = &means.outward;
    spindle.tapping_max.min(axis.feed_speed.of_linear() / tap.lead.abs())
}

/// What is left below this counts as no peck of its own, mm.
const NO_PECK: f64 = 1e-6;

/// What a sound tap is planned with.
pub(super) struct Means {
    pub(super) inward: (AxisLimits, SpindleLimits),
    outward: (AxisLimits, SpindleLimits),
    /// What the spindle turns up and down with where nothing ties it to the feed: no preset is for
    /// that.
    pub(super) turning: SpindleLimits,
    cut: Torque,
    /// Torque from which on the tap is taken out of its hole.
    torque_limit: Option<Torque>,
    /// How much deeper than programmed there is room for the tap.
    room: Length,
    /// Acceleration asked for on the way out.
    spindle_accel: Option<SpinAccel>,
}

/// One way in and the way back, as coordinates of the axis.
#[derive(Clone, Copy)]
struct Peck {
    from: Length,
    bottom: Length,
    end: Length,
}

impl Planner {
    pub(super) fn tap(&mut self, job: &mut Job, tap: &Tap) {
        self.come_down(job);
        self.judge_tap(job, tap);
        let means = self.judge(job, tap);
        match (means, self.tap_in_spindle().map(|(_, tool)| tool.holder)) {
            (Some(means), Some(Holder::Clutch { spline_length, pawl_backlash, .. })) => {
                self.clutch_tap(job, tap, &means, Clutch { spline_length, pawl_backlash });
            }
            (Some(means), Some(holder)) if self.options.taps.method == TapMethod::Floating => {
                self.floating_tap(job, tap, &means, holder);
            }
            (means, _) => self.synchronised_tap(job, tap, means),
        }
        if wild(&tap.start).is_none() {
            self.programmed = tap.start;
        }
    }

    fn synchronised_tap(&mut self, job: &mut Job, tap: &Tap, means: Option<Means>) {
        self.rest(job, 0);
        if let Some(means) = means {
            self.warn_of_slow_return(job, tap, &means);
            for peck in pecks(tap, self.limits.tapping.retract) {
                let plan = self.tap_plan(tap, &peck, &means);
                self.hand_on(job, StepKind::Tap(plan.into()));
            }
        }
    }

    /// All findings about a tap; what to plan it with if none of them refuses it.
    fn judge(&mut self, job: &Job, tap: &Tap) -> Option<Means> {
        let turns = (tap.bottom - tap.start.along(tap.axis).of_linear()) / tap.lead;
        let seconds = (turns / tap.spin).abs() + (turns / tap.return_spin).abs() + tap.dwell;
        if self.numbers_are_refused(job, tap) || self.time_is_refused(job, seconds.value()) {
            return None;
        }
        let place = self.place_is_refused(job, tap);
        let place = self.axis_is_refused(job, tap) || place;
        let (axis, spindle) = self.drives(job, tap)?;
        let tapping = &self.limits.tapping;
        let inward = tapping.inward.of(&axis, &spindle);
        let outward = tapping.outward.of(&axis, &spindle);
        let Some((tool, tap_tool)) = self.tap_in_spindle() else {
            let finding = self.not_a_tap(job);
            self.findings.add(finding);
            return None;
        };
        if tool.stand_in {
            // its size, flutes and hole are not known: nothing of it is judged
            let room = Length::mm(tap_tool.lead.abs().value());
            let cut = Torque::ZERO;
            return Some(Means {
                inward,
                outward,
                turning: spindle,
                cut,
                torque_limit: tap_tool.max_torque,
                room,
                spindle_accel: None,
            });
        }
        let hole = self.drilled_hole(tap, tool);
        let pressure = self.options.cutting_pressure_n_per_mm2;
        let cut = cutting_torque(tool, tap_tool, hole.map(|h| h.diameter), pressure);
        let torque_limit = Some(torque_limit(tool, tap_tool));
        let check = TapCheck {
            tap,
            span: job.span,
            tool,
            tap_tool,
            axis: &inward.0,
            spindle: &inward.1,
            hole,
            own_ramps: self.limits.tapping.own_ramps,
            frame: &self.frame,
            coasts: self.limits.tapping.coasts,
        };
        let mut found = check.findings(cut);
        let room = check.room();
        if hole.is_none() && tap.axis == Axis::Z {
            let beside = self.holes.beside(&tap.start, tool.diameter);
            let frame = &self.frame;
            found.extend(beside.map(|(hole, off)| beside_its_hole(job.span, &hole, off, frame)));
        }
        let spindle_accel = self.return_acceleration(job, tap, &outward, cut);
        if let Err(finding) = &spindle_accel {
            found.push(finding.clone());
        }
        self.outbox.heat.cuts_with(cut);
        let refused = place || found.iter().any(Diagnostic::is_error);
        for finding in found {
            self.findings.add(finding);
        }
        if !refused && hole.is_none() && tap.axis == Axis::Z {
            let text = "no hole was drilled here by this program: it is taken to be there, deep enough and of the \
                        right size";
            self.findings.add_once(Diagnostic::note("M0324", job.span, text));
        }
        let spindle_accel = spindle_accel.ok().filter(|_| !refused)?;
        Some(Means { inward, outward, turning: spindle, cut, torque_limit, room, spindle_accel })
    }

    /// The acceleration asked for on the way out (I), if drives and ramps can obey it.
    fn return_acceleration(
        &self,
        job: &Job,
        tap: &Tap,
        outward: &(AxisLimits, SpindleLimits),
        cut: Torque,
    ) -> Result<Option<SpinAccel>, Diagnostic> {
        if tap.return_acceleration == ReturnAcceleration::AsSet {
            return Ok(None);
        }
        let tapping = &self.limits.tapping;
        let why = if tapping.own_ramps.is_some() {
            "the spindle's drive makes ramps of its own"
        } else if self.options.force_ramp.is_some() {
            "the run-up of every tap is set to a time"
        } else {
            ""
        };
        if !why.is_empty() {
            let text = format!(
                "a return acceleration (I) cannot be obeyed here, because {why}: leave I out"
            );
            return Err(Diagnostic::error("M0345", job.span, text));
        }
        let request = StrokeRequest {
            revolutions: Angle::ZERO,
            spin: tap.return_spin,
            lead: tap.lead,
            cut,
            spindle_accel: None,
            force_ramp: None,
        };
        let highest = request.acceleration_from_rest(&outward.1, &outward.0);
        match tap.return_acceleration {
            ReturnAcceleration::Limit(asked) if asked > highest => {
                let text = format!(
                    "a return acceleration of {} rev/s² is more than spindle and {} give from rest, {} rev/s²: \
                     I{} works",
                    number(asked.value()),
                    tap.axis.letter(),
                    number(highest.value()),
                    number(libm::floor(highest.value())),
                );
                Err(Diagnostic::error("M0344", job.span, text))
            }
            ReturnAcceleration::Limit(asked) => Ok(Some(asked)),
            ReturnAcceleration::Share(share) => Ok(Some(highest * share)),
            ReturnAcceleration::AsSet => Ok(None),
        }
    }

    /// The axis and the spindle that a tap needs.
    fn drives(&mut self, job: &Job, tap: &Tap) -> Option<(AxisLimits, SpindleLimits)> {
        let both = self.limits.axes[tap.axis.index()].zip(self.limits.spindles.first().copied());
        if both.is_none() {
            let letter = tap.axis.letter();
            let text =
                format!("tapping needs a spindle and a {letter} axis, which this machine lacks");
            self.findings.add(Diagnostic::error("M0305", job.span, text));
        }
        both
    }

    fn tap_in_spindle(&self) -> Option<(&Tool, &TapTool)> {
        let tool = self.tools.get(self.tool)?;
        match &tool.kind {
            ToolKind::Tap(tap_tool) => Some((tool, tap_tool)),
            _ => None,
        }
    }

    fn not_a_tap(&self, job: &Job) -> Diagnostic {
        let number = self.tool;
        let text: String = match self.tools.get(number) {
            Some(tool) => {
                let kind = tool.kind_name();
                let text = format!("expected a tap in the spindle, found T{number} ({kind})");
                let finding = Diagnostic::error("M0328", job.span, text);
                return match thread_missing(tool) {
                    Some(help) => finding.with_help(help),
                    None => finding,
                };
            }
            None if number == 0 => "there is no tool in the spindle to tap with".into(),
            None => format!("T{number} is in the spindle, but not in the tool table"),
        };
        Diagnostic::error("M0329", job.span, text)
    }

    fn drilled_hole(&self, tap: &Tap, tool: &Tool) -> Option<Drilled> {
        let along_z = tap.axis == Axis::Z;
        along_z.then(|| self.holes.at(&tap.start, tap.bottom - tool.worn_length())).flatten()
    }

    /// Numbers that make no tap.
    fn numbers_are_refused(&mut self, job: &Job, tap: &Tap) -> bool {
        let stroke = tap.bottom - tap.start.along(tap.axis).of_linear();
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let numbers = [
            stroke.value().abs(),
            tap.lead.value().abs(),
            tap.spin.value(),
            tap.return_spin.value(),
        ];
        let pecks = tap.peck.is_none_or(|peck| positive(peck.value()));
        let others =
            pecks && tap.surface.is_finite() && tap.dwell.is_finite() && tap.dwell >= Time::ZERO;
        let sound = numbers.into_iter().all(positive) && others && wild(&tap.start).is_none();
        if !sound {
            let text = format!(
                "a tap needs a depth, a lead and a speed above zero, found a stroke of {}, {} per revolution, S{}",
                length(&self.frame, stroke.value()),
                length(&self.frame, tap.lead.value()),
                number(tap.spin.in_rpm()),
            );
            self.findings.add(Diagnostic::error("M0333", job.span, text));
        }
        !sound
    }

    /// An axis that would have to move within it, or a depth beyond the travel.
    fn place_is_refused(&mut self, job: &Job, tap: &Tap) -> bool {
        let mut refused = false;
        for axis in Axis::ALL {
            let off = change(&self.programmed, &tap.start, axis);
            if off.abs() > AT_START {
                refused = true;
                let off = if is_rotary(axis) {
                    format!("{}°", number(off))
                } else {
                    length(&self.frame, off)
                };
                let text = format!(
                    "expected only {} to move in a tap, found {} moving by {off}: move there in a block before",
                    tap.axis.letter(),
                    axis.letter(),
                );
                self.findings.add(Diagnostic::error("M0330", job.span, text));
            }
        }
        let path = motion::Path::Line {
            from: tap.start,
            to: tap.start.with(tap.axis, Coordinate::linear(tap.bottom)),
        };
        self.is_refused(job, &[path]) || refused
    }

    /// A tap along an axis in which the spindle does not hold its tool.
    fn axis_is_refused(&mut self, job: &Job, tap: &Tap) -> bool {
        let own = self.limits.tapping.axis;
        let refused = tap.axis != own;
        if refused {
            let plane = match own {
                Axis::X => "G19",
                Axis::Y => "G18",
                _ => "G17",
            };
            let (found, own) = (tap.axis.letter(), own.letter());
            let text = format!(
                "the spindle of this machine holds its tap along {own}, and this block taps along {found}: \
                 {plane} and a depth in {own} work"
            );
            self.findings.add(Diagnostic::error("M0334", job.span, text));
        }
        refused
    }

    fn warn_of_slow_return(&mut self, job: &Job, tap: &Tap, means: &Means) {
        let highest = highest_return(tap, means);
        if tap.return_spin.value() > highest.value() * (1.0 + 1e-9) {
            let text = format!(
                "the return at S{} is faster than spindle and axis can tap: it runs at S{}",
                number(tap.return_spin.in_rpm()),
                number(whole_rpm(highest)),
            );
            self.findings.add(Diagnostic::warning("M0332", job.span, text));
        }
    }

    fn tap_plan(&mut self, tap: &Tap, peck: &Peck, means: &Means) -> TapPlan {
        let start = tap.start.along(tap.axis).of_linear();
        let direction = if tap.bottom < start { -1.0 } else { 1.0 };
        let sense = if tap.lead < Lead::ZERO { -1.0 } else { 1.0 };
        let turns = |from: Length, to: Length| -> Angle { (to - from).abs() / tap.lead.abs() };
        let request = StrokeRequest {
            revolutions: turns(peck.from, peck.bottom),
            spin: tap.spin,
            lead: tap.lead,
            cut: means.cut,
            spindle_accel: None,
            force_ramp: self.ramp_of_stroke(tap.spin),
        };
        let revolutions = turns(peck.bottom, peck.end);
        let return_spin = tap.return_spin.min(highest_return(tap, means));
        let force_ramp = self.ramp_of_stroke(return_spin);
        let spindle_accel = means.spindle_accel;
        let back =
            StrokeRequest { revolutions, spin: return_spin, force_ramp, spindle_accel, ..request };
        let inward = self.stroke(request, &means.inward, 0);
        let outward = self.stroke(back, &means.outward, 1);
        // on the helix through the start: where a peck begins deeper, the spindle stands that much
        // further
        let angle = |at: Angle| at + turns(start, peck.from) * sense;
        let start_angle = match tap.start_angle {
            None if tap.peck.is_some() => Some(angle(Angle::ZERO)),
            asked => asked.map(angle),
        };
        TapPlan {
            axis: tap.axis,
            spindle: 0,
            start: tap.start.with(tap.axis, Coordinate::linear(peck.from)),
            bottom: peck.bottom,
            deepest: tap.bottom + means.room * direction,
            end: peck.end,
            surface: tap.surface,
            lead: tap.lead * direction,
            spin: tap.spin * sense,
            return_spin: return_spin * -sense,
            inward: inward.profile,
            dwell: if peck.bottom == tap.bottom { tap.dwell } else { Time::ZERO },
            outward: outward.profile,
            start_angle,
            turns_at_speed: self
                .limits
                .tapping
                .own_ramps
                .is_some_and(|own| own.turns_at_speed(tap.spin, request.revolutions, tap.lead)),
            limiting: inward.limiting,
            torque_expected: means.cut,
            torque_limit: means.torque_limit,
        }
    }

    /// How long the run-up of a stroke takes where torque and power do not say it: as the user
    /// asked, or as the drive makes it.
    fn ramp_of_stroke(&self, spin: Spin) -> Option<Time> {
        let own = self.limits.tapping.own_ramps;
        self.options.force_ramp.or_else(|| own.map(|own| spin / own.accel.min(own.decel)))
    }

    /// A stroke in (0) or out (1); holes of a pattern are alike, so the last ones are remembered.
    fn stroke(
        &mut self,
        request: StrokeRequest,
        limits: &(AxisLimits, SpindleLimits),
        way: usize,
    ) -> Stroke {
        match self.last_strokes[way] {
            Some((same, stroke)) if same == request => stroke,
            _ => {
                let stroke = request.plan(&limits.1, &limits.0);
                self.last_strokes[way] = Some((request, stroke));
                stroke
            }
        }
    }
}

/// The pecks of a tap, the only one of a tap without Q. A chip is broken only where that leaves the
/// tap on its way: a retract as long as the peck or longer comes out to the start.
fn pecks(tap: &Tap, retract: Retract) -> impl Iterator<Item = Peck> {
    let (start, to) = (tap.start.along(tap.axis).of_linear(), tap.bottom);
    let stroke = (to - start).abs();
    let into = if to < start { -1.0 } else { 1.0 };
    let depth = tap.peck.map_or(stroke, |peck| peck.min(stroke));
    let end_of = move |bottom: Length| match retract {
        Retract::By(back) if bottom != to && back < depth => bottom - back * into,
        _ => start,
    };
    let count = libm::ceil((stroke.value() - NO_PECK) / depth.value()).max(1.0);
    let mut from = start;
    (1..=count as u32).map(move |k| {
        let last = f64::from(k) >= count;
        let bottom = if last { to } else { start + depth * (into * f64::from(k)) };
        let peck = Peck { from, bottom, end: end_of(bottom) };
        from = peck.end;
        peck
    })
}

/// A tap that would meet a drilled hole off its centre: it would be bent and break.
fn beside_its_hole(span: Span, hole: &Drilled, off: Length, frame: &ProgramFrame) -> Diagnostic {
    let text = format!(
        "the tap would meet the hole of {} drilled here {} off its centre",
        length(frame, hole.diameter.value()),
        length(frame, off.value()),
    );
    Diagnostic::error("M0335", span, text)
        .with_label(hole.span, "drilled here")
        .with_help("tap at the place that was drilled")
}

/// What to write in the row of a tool whose description speaks of a tap and names no thread.
fn thread_missing(tool: &Tool) -> Option<String> {
    let mut words = tool.description.split(|c: char| !c.is_alphanumeric());
    let says_tap = words.any(|word| word.eq_ignore_ascii_case("tap"));
    (says_tap && matches!(tool.kind, ToolKind::Other)).then(|| {
        format!(
            "its row in the tool table says \"{}\" and no thread: \"M6 tap\" or \"1/4-20 UNC tap\" would be understood",
            tool.description
        )
    })
}

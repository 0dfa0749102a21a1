//! A tap: judged, then planned as two strokes.
//!
//! ```text
//!   spindle at rest ─► [in: N rev, rest to rest] ─► dwell ─► [out: N rev, rest to rest] ─► at rest
//! ```
//!
//! | canon::Tap | TapPlan |
//! |---|---|
//! | lead along the tap's own direction, + right-hand | axis travel per +1 rev: that times the direction of the stroke |
//! | speeds without sign | + clockwise: a right-hand tap goes in with + and out with − |
use super::refuse::wild;
use super::{Job, Planner};
use crate::findings::number;
use crate::holes::Drilled;
use crate::limits::{AxisLimits, SpindleLimits};
use crate::motion::change;
use crate::step::{StepKind, TapPlan};
use crate::stroke::{Stroke, StrokeRequest};
use crate::tap_check::{TapCheck, cutting_torque, whole_rpm};
use alloc::{format, string::String};
use canon::{Axis, Tap, TapTool, Tool, ToolKind};
use diag::Diagnostic;
use units::{Angle, Lead, Length, Time, Torque};

/// The axes stand at the start if they are this near to it, mm.
const AT_START: f64 = 1e-6;

/// What a sound tap is planned with.
struct Means {
    axis: AxisLimits,
    spindle: SpindleLimits,
    cut: Torque,
}

impl Planner {
    pub(super) fn tap(&mut self, job: &mut Job, tap: &Tap) {
        self.come_down(job);
        let means = self.judge(job, tap);
        self.rest(job, 0);
        if let Some(means) = means {
            let plan = self.tap_plan(job, tap, &means);
            self.hand_on(job, StepKind::Tap(plan));
        }
        if wild(&tap.start).is_none() {
            self.programmed = tap.start;
        }
    }

    /// All findings about a tap; what to plan it with if none of them refuses it.
    fn judge(&mut self, job: &Job, tap: &Tap) -> Option<Means> {
        let turns = (tap.bottom - tap.start.along(tap.axis)) / tap.lead;
        let seconds = (turns / tap.spin).abs() + (turns / tap.return_spin).abs() + tap.dwell;
        if self.numbers_are_refused(job, tap) || self.time_is_refused(job, seconds.value()) {
            return None;
        }
        let place = self.place_is_refused(job, tap);
        let (axis, spindle) = self.drives(job, tap)?;
        let Some((tool, tap_tool)) = self.tap_in_spindle() else {
            let finding = self.not_a_tap(job);
            self.findings.add(finding);
            return None;
        };
        let hole = self.drilled_hole(tap, tool);
        let pressure = self.options.cutting_pressure_n_per_mm2;
        let cut = cutting_torque(tool, tap_tool, hole.map(|h| h.diameter), pressure);
        let check =
            TapCheck { tap, span: job.span, tool, tap_tool, axis: &axis, spindle: &spindle, hole };
        let found = check.findings(cut);
        let refused = place || found.iter().any(Diagnostic::is_error);
        for finding in found {
            self.findings.add(finding);
        }
        if !refused && hole.is_none() && tap.axis == Axis::Z {
            let text = "no hole was drilled here by this program: it is taken to be there, deep enough and of the \
                        right size";
            self.findings.add_once(Diagnostic::note("M0324", job.span, text));
        }
        (!refused).then_some(Means { axis, spindle, cut })
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
        let (code, text): (_, String) = match self.tools.get(number) {
            Some(tool) => {
                let kind = kind_name(tool);
                ("M0328", format!("expected a tap in the spindle, found T{number} ({kind})"))
            }
            None if number == 0 => ("M0329", "there is no tool in the spindle to tap with".into()),
            None => ("M0329", format!("T{number} is in the spindle, but not in the tool table")),
        };
        Diagnostic::error(code, job.span, text)
    }

    fn drilled_hole(&self, tap: &Tap, tool: &Tool) -> Option<Drilled> {
        let along_z = tap.axis == Axis::Z;
        along_z.then(|| self.holes.at(&tap.start, tap.bottom - tool.length)).flatten()
    }

    /// Numbers that make no tap.
    fn numbers_are_refused(&mut self, job: &Job, tap: &Tap) -> bool {
        let stroke = tap.bottom - tap.start.along(tap.axis);
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let numbers = [
            stroke.value().abs(),
            tap.lead.value().abs(),
            tap.spin.value(),
            tap.return_spin.value(),
        ];
        let others = tap.surface.is_finite() && tap.dwell.is_finite() && tap.dwell >= Time::ZERO;
        let sound = numbers.into_iter().all(positive) && others && wild(&tap.start).is_none();
        if !sound {
            let text = format!(
                "a tap needs a depth, a lead and a speed above zero, found a stroke of {} mm, {} mm per revolution, S{}",
                number(stroke.value()),
                number(tap.lead.value()),
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
                let text = format!(
                    "expected only {} to move in a tap, found {} moving by {} mm: move there in a block before",
                    tap.axis.letter(),
                    axis.letter(),
                    number(off),
                );
                self.findings.add(Diagnostic::error("M0330", job.span, text));
            }
        }
        let path = crate::Path::Line { from: tap.start, to: tap.start.with(tap.axis, tap.bottom) };
        self.is_refused(job, &path) || refused
    }

    fn tap_plan(&mut self, job: &Job, tap: &Tap, means: &Means) -> TapPlan {
        let start = tap.start.along(tap.axis);
        let travel = tap.bottom - start;
        let direction = if travel < Length::ZERO { -1.0 } else { 1.0 };
        let sense = if tap.lead < Lead::ZERO { -1.0 } else { 1.0 };
        let revolutions: Angle = travel.abs() / tap.lead.abs();
        let request = StrokeRequest {
            revolutions,
            spin: tap.spin,
            lead: tap.lead,
            cut: means.cut,
            force_ramp: self.options.force_ramp,
        };
        let inward = self.stroke(request, means);
        let outward = self.stroke(StrokeRequest { spin: tap.return_spin, ..request }, means);
        let highest = means.spindle.tapping_max.min(means.axis.feed_speed / tap.lead.abs());
        if tap.return_spin.value() > highest.value() * (1.0 + 1e-9) {
            let text = format!(
                "the return at S{} is faster than spindle and axis can tap: it runs at S{}",
                number(tap.return_spin.in_rpm()),
                number(whole_rpm(highest)),
            );
            self.findings.add(Diagnostic::warning("M0332", job.span, text));
        }
        TapPlan {
            axis: tap.axis,
            spindle: 0,
            start: tap.start,
            bottom: tap.bottom,
            surface: tap.surface,
            lead: tap.lead * direction,
            spin: tap.spin * sense,
            return_spin: tap.return_spin * -sense,
            inward: inward.profile,
            dwell: tap.dwell,
            outward: outward.profile,
            start_angle: tap.start_angle,
            limiting: inward.limiting,
        }
    }

    /// A stroke; holes of a pattern are alike, so the last one is remembered.
    fn stroke(&mut self, request: StrokeRequest, means: &Means) -> Stroke {
        match self.last_stroke {
            Some((same, stroke)) if same == request => stroke,
            _ => {
                let stroke = request.plan(&means.spindle, &means.axis);
                self.last_stroke = Some((request, stroke));
                stroke
            }
        }
    }
}

fn kind_name(tool: &Tool) -> &'static str {
    match tool.kind {
        ToolKind::Drill { .. } => "a drill",
        ToolKind::SpotDrill { .. } => "a spot drill",
        ToolKind::EndMill => "an end mill",
        ToolKind::Tap(_) => "a tap",
        ToolKind::Other if tool.stand_in => "a stand-in that the table does not describe",
        ToolKind::Other => "another tool",
    }
}

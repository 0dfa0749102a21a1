//! Calls to operations: from the program's frame and units to machine coordinates in mm.
//!
//! ```text
//!   Call::Line(to)   ──► ×25.4 if inches ──► Frame::to_machine ──► Op::Line { to, feed }
//!   Call::FeedRate   ──► feed, per minute or revolution or as the move's duration
//!   Call::SyncStart  ──► the lines that follow are Op::Threading
//!   Call::Tap        ──► lead = F/S (G94) or F (G95); start, bottom, surface on the tap's axis
//! ```
//!
//! What cannot be said as an operation (a tap with an X word, an arc of a plane that the rotation
//! tilts) is an error with its place. Moves of no length are left out.
//!
//! ```text
//!   stroke       the box of the stored stroke check
//!   takes_time   operations by which the machine moves or waits
//! ```
//!
//! The operations of a cycle are made in its file; which call leads where stands in
//! [`calls`](crate::operations::calls).
pub(crate) mod lead;
pub(crate) mod stroke;
mod takes_time;

use crate::{
    call::{Call, Corners, CycleHole, Sense, Units},
    fault::unknown::Unknown,
    geometry::{
        frame::{self, Frame, Point, machine_point, same},
        offset_curve::sweep_rad,
    },
    setup::Setup,
};
use canon::{
    Arc, Axis, Feed, LengthUnit, Op, OpKind, Output, PathMode, Plane, Position, ProgramFrame,
    SpindleOrder, Threading, ToolLibrary,
};
use diag::{Diagnostic, Span};
use std::collections::VecDeque;
use units::{Angle, Lead, LeadGrowth, Length, MM_PER_INCH, Speed, Time};

/// No machine is larger, mm (or degrees): 10 km.
const FARTHEST: f64 = 1e7;

/// Turns calls into operations.
#[derive(Clone)]
pub struct Resolver {
    pub(crate) ops: VecDeque<Op>,
    pub(crate) diagnostics: Vec<Diagnostic>,
    most_findings: usize,
    pub(crate) tools: ToolLibrary,
    /// T names what is clamped by hand.
    pub(crate) tools_by_hand: bool,
    pub(crate) tool: u32,
    pub(crate) units: Units,
    /// Offsets, mm.
    pub(crate) frame: Frame,
    /// Number of the work offset in force, 1 for G54.
    work_offset: u8,
    /// Where the axes stand, mm and degrees.
    pub(crate) at: Point,
    pub(crate) feed: FeedOrder,
    /// Lead of the thread that lines turn, mm, and by how much it grows in each turn.
    pub(crate) threading: Option<(f64, f64)>,
    /// G22.
    pub(crate) zone: Option<crate::StrokeZone>,
    /// Where in the spindle's turn it begins.
    pub(crate) thread_angle: Angle,
    pub(crate) spindle: SpindleState,
    pub(crate) path: PathMode,
    pub(crate) path_said: Option<PathMode>,
    pub(crate) overrides: (bool, bool),
    pub(crate) coolant: (bool, bool),
    /// The tool of which it was said that its own pitch counts.
    pub(crate) pitch_said: Option<u32>,
    /// Tool and line of which it was said that a lead is rounded.
    pub(crate) rounding_said: Option<(u32, u32)>,
    /// Outputs that change when the next move begins.
    pub(crate) with_motion: Vec<(Span, Output)>,
    /// What is not known since a block was refused, and what operations have missed.
    pub(crate) unknown: Unknown,
    pub(crate) missed: Unknown,
    /// An operation came by which the machine moves or waits.
    pub(crate) time_passed: bool,
}

/// F and what it counts.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct FeedOrder {
    /// Program units (or degrees) per minute or revolution.
    rate: f64,
    /// Millimetres in one program unit when it was given.
    mm: f64,
    per_revolution: bool,
    duration_s: Option<f64>,
}

/// The spindle as ordered.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct SpindleState {
    pub(crate) speed: f64,
    pub(crate) sense: Option<Sense>,
    /// G96: limit in rev/min, infinite if none was stated.
    pub(crate) surface: Option<f64>,
    pub(crate) said: Option<SpindleOrder>,
}

impl Resolver {
    /// At the beginning of a program.
    pub fn new(setup: &Setup) -> Self {
        Self {
            ops: VecDeque::new(),
            diagnostics: Vec::new(),
            most_findings: setup.limits.findings,
            tools: setup.tools.clone(),
            tools_by_hand: setup.dialect.rules().tools_by_hand,
            tool: 0,
            units: Units::Millimetre,
            frame: Frame::default(),
            work_offset: 1,
            at: machine_point(&setup.start),
            feed: FeedOrder { rate: 0.0, mm: 1.0, per_revolution: false, duration_s: None },
            threading: None,
            zone: None,
            thread_angle: Angle::ZERO,
            spindle: SpindleState { speed: 0.0, sense: None, surface: None, said: None },
            path: PathMode::Blend { tolerance: None, merge: None },
            path_said: None,
            overrides: (true, true),
            coolant: (false, false),
            pitch_said: None,
            rounding_said: None,
            with_motion: Vec::new(),
            unknown: Unknown::default(),
            missed: Unknown::default(),
            time_passed: false,
        }
    }

    /// Whether it follows from a refusal before, or was told of the operation before.
    fn is_explained(&self, code: &str) -> bool {
        self.unknown.explain(code) || self.missed.explain(code)
    }

    /// All is known: another text begins.
    pub(crate) fn forget_findings(&mut self) {
        self.diagnostics.clear();
        (self.unknown, self.missed) = (Unknown::default(), Unknown::default());
    }

    /// The next operation, if one is ready.
    pub fn pop(&mut self) -> Option<Op> {
        self.ops.pop_front()
    }

    /// What was found.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// What was found, which it forgets.
    pub fn take_findings(&mut self) -> Vec<Diagnostic> {
        core::mem::take(&mut self.diagnostics)
    }

    /// How the program writes places now; `system` is the work offset in force.
    pub(crate) fn program_frame(&self, system: u8, x_is_diameter: bool) -> ProgramFrame {
        ProgramFrame {
            unit: match self.units {
                Units::Millimetre => LengthUnit::Millimetre,
                Units::Inch => LengthUnit::Inch,
            },
            work_offset: system,
            origin: position(&self.frame.origin),
            added: position(&self.frame.added),
            rotation: Angle::deg(self.frame.rotation()),
            tool: position(&self.frame.tool),
            x_is_diameter,
            ..ProgramFrame::default()
        }
    }

    pub(crate) fn report(&mut self, diagnostic: Diagnostic) {
        if diagnostic.is_error() && self.is_explained(diagnostic.code) {
            return;
        }
        if diagnostic.is_error() {
            self.missed.miss(diagnostic.code);
        }
        let known =
            self.diagnostics.iter().any(|d| d.code == diagnostic.code && d.span == diagnostic.span);
        if !known && self.diagnostics.len() < self.most_findings {
            self.diagnostics.push(diagnostic);
        }
    }

    #[inline]
    pub(crate) fn push(&mut self, span: Span, kind: OpKind) {
        if !self.with_motion.is_empty()
            && matches!(
                kind,
                OpKind::Rapid { .. }
                    | OpKind::Line { .. }
                    | OpKind::Arc { .. }
                    | OpKind::Spline { .. }
                    | OpKind::Probe(_)
                    | OpKind::Tap(_)
                    | OpKind::Threading(_)
            )
        {
            for (span, output) in self.with_motion.drain(..) {
                self.ops.push_back(Op { span, kind: OpKind::Output(output) });
            }
        }
        self.time_passed |= takes_time::takes_time(&kind);
        self.ops.push_back(Op { span, kind });
    }

    pub(crate) const fn mm(&self) -> f64 {
        self.units.in_mm()
    }

    /// Machine coordinates of a point of the program.
    #[inline]
    pub(crate) fn machine(&self, program: &Point) -> Point {
        let mut point = *program;
        if self.units == Units::Inch {
            frame::scale(&mut point, MM_PER_INCH);
        }
        self.frame.to_machine(&point)
    }

    fn in_mm(&self, mut point: Point) -> Point {
        frame::scale(&mut point, self.mm());
        point
    }

    /// Reported.
    #[inline]
    pub(crate) fn is_too_far(&mut self, to: &Point, span: Span) -> bool {
        let Some(i) = (0..9).find(|i| to[*i].is_nan() || to[*i].abs() > FARTHEST) else {
            return false;
        };
        let (axis, at) = (Axis::ALL[i], to[i]);
        let (letter, unit) = (axis.letter(), axis.kind().unit());
        let text = format!("{letter} would go to {at}{unit}: farther than any machine");
        self.report(Diagnostic::error("I0701", span, text));
        true
    }

    /// Whether a move to this point is one to be made; remembers where it ends.
    #[inline]
    pub(crate) fn arrives(&mut self, to: &Point, span: Span) -> bool {
        if self.is_too_far(to, span) {
            return false;
        }
        let moves = !same(&self.at, to);
        if moves {
            self.at = *to;
            self.say_path(span);
        }
        moves
    }

    /// The path mode, where it has changed since the last move.
    #[inline]
    pub(crate) fn say_path(&mut self, span: Span) {
        if self.path_said != Some(self.path) {
            self.path_said = Some(self.path);
            self.push(span, OpKind::PathMode(self.path));
        }
    }

    #[inline]
    pub(crate) fn rapid(&mut self, to: &Point, span: Span) {
        let from = self.at;
        if self.arrives(to, span) {
            self.check_stroke(&from, to, span);
            self.push(span, OpKind::Rapid { to: position(to) });
        }
    }

    #[inline]
    pub(crate) fn line(&mut self, program: &Point, span: Span) {
        let to = self.machine(program);
        let from = self.at;
        if self.arrives(&to, span) {
            self.check_stroke(&from, &to, span);
            let kind = match self.threading {
                Some(leads) => OpKind::Threading(self.stretch(&from, &to, leads)),
                None => OpKind::Line { to: position(&to), feed: self.feed(&from, &to, span) },
            };
            self.push(span, kind);
        }
    }

    /// Refuse a straight move that goes where the box of G22 forbids it.
    #[inline]
    pub(crate) fn check_stroke(&mut self, from: &Point, to: &Point, span: Span) {
        if self.zone.is_some() {
            self.check_way(&stroke::straight(from, to), span);
        }
    }

    fn check_way(&mut self, way: &[stroke::Coordinate; 3], span: Span) {
        let refusal = self.zone.as_ref().and_then(|zone| stroke::refusal(zone, way, span));
        if let Some(refusal) = refusal {
            self.report(refusal);
        }
    }

    /// A stretch of a turned thread, all in machine coordinates.
    fn stretch(&self, from: &Point, to: &Point, (lead, growth): (f64, f64)) -> Threading {
        let way = |i: usize| (to[i] - from[i]).abs();
        let farthest = (0..3).fold(2, |most, i| if way(i) > way(most) { i } else { most });
        let zero = self.machine(&[0.0; 9])[farthest];
        let within =
            (from[farthest].min(to[farthest])..=from[farthest].max(to[farthest])).contains(&zero);
        Threading {
            to: position(to),
            lead: Lead::mm_per_rev(lead),
            growth: LeadGrowth::mm_per_rev2(growth),
            start_angle: self.thread_angle,
            axis: Axis::ALL[farthest],
            surface: Length::mm(if within { zero } else { from[farthest] }),
        }
    }

    /// The lead that F means for a tap: F/S, or F itself with G95; `None` where no F is in force.
    pub(crate) fn lead_by_feed(&self) -> Option<f64> {
        let rate = self.feed.rate * self.feed.mm;
        (rate > 0.0)
            .then(|| if self.feed.per_revolution { rate } else { rate / self.spindle.speed })
    }

    /// F that would mean a lead of 1 mm.
    pub(crate) fn feed_of_a_mm(&self) -> f64 {
        let per_mm = 1.0 / self.feed.mm;
        if self.feed.per_revolution { per_mm } else { per_mm * self.spindle.speed }
    }

    /// F as it counts on this way.
    #[inline]
    pub(crate) fn feed(&mut self, from: &Point, to: &Point, span: Span) -> Feed {
        if let Some(seconds) = self.feed.duration_s.take() {
            return Feed::Duration(Time::s(seconds));
        }
        let linear = [0, 1, 2, 6, 7, 8].into_iter().any(|i| (to[i] - from[i]).abs() > 1e-9);
        if self.feed.per_revolution && self.spindle.sense.is_none() {
            let text =
                "with G95 the feed follows the spindle, which does not turn: write M3 or M4 before";
            self.report(Diagnostic::error("I0702", span, text));
        }
        if linear {
            let rate = self.feed.rate * self.feed.mm;
            return if self.feed.per_revolution {
                Feed::PerRevolution(Lead::mm_per_rev(rate))
            } else {
                Feed::PerTime(Speed::mm_per_min(rate))
            };
        }
        let degrees = (3..6).map(|i| (to[i] - from[i]).powi(2)).sum::<f64>().sqrt();
        let per_minute = if self.feed.per_revolution {
            self.feed.rate * self.spindle.speed
        } else {
            self.feed.rate
        };
        Feed::Duration(Time::s(60.0 * degrees / per_minute))
    }

    pub(crate) fn arc(
        &mut self,
        plane: Plane,
        program: &Point,
        centre: [f64; 2],
        turns: i32,
        span: Span,
    ) {
        if !self.plane_is_straight(plane, span) {
            return;
        }
        let [a, b, _] = plane.axes().map(Axis::index);
        let mut middle = *program;
        (middle[a], middle[b]) = (centre[0], centre[1]);
        let (to, middle, from) = (self.machine(program), self.machine(&middle), self.at);
        let centre = [middle[a], middle[b]];
        let sweep = sweep_rad([from[a], from[b]], [to[a], to[b]], centre, turns);
        if !self.arrives(&to, span) {
            self.say_path(span); // a full circle ends where it began
        }
        if self.zone.is_some() {
            self.check_way(&stroke::round([a, b], (&from, &to), centre, sweep), span);
        }
        let feed = self.feed(&[0.0; 9], &[1.0; 9], span);
        let arc = Arc {
            plane,
            centre: centre.map(Length::mm),
            sweep: Angle::rev(sweep / core::f64::consts::TAU),
        };
        self.push(span, OpKind::Arc { to: position(&to), arc, feed });
    }

    /// A rotation of X and Y tilts the other two planes, which no op can say.
    pub(crate) fn plane_is_straight(&mut self, plane: Plane, span: Span) -> bool {
        let straight = plane == Plane::XY || self.frame.rotation() == 0.0;
        if !straight {
            let text = format!(
                "the work offset is turned by {}° about Z: arcs and cycles are possible in G17 only",
                self.frame.rotation()
            );
            self.report(Diagnostic::error("I0706", span, text));
        }
        straight
    }

    /// The axis of a cycle, and its level in machine coordinates.
    pub(crate) fn level(&self, hole: &CycleHole, level: f64) -> f64 {
        let n = hole.plane.normal().index();
        let mut point = hole.at;
        point[n] = level;
        self.machine(&point)[n]
    }

    /// Where another work offset than the first has its zero; `None` with the first one, G54.
    pub(crate) fn own_zero(&self) -> Option<Position> {
        (self.work_offset != 1).then(|| position(&self.frame.origin))
    }

    /// Where the material is taken to begin: the work's zero if it lies in the stroke, else its
    /// start.
    pub(crate) fn surface(start: f64, bottom: f64) -> f64 {
        if start.min(bottom) <= 0.0 && 0.0 <= start.max(bottom) { 0.0 } else { start }
    }

    /// Sense of the spindle in force: +1 clockwise, −1 counter-clockwise, 0 still.
    pub(crate) fn spindle_sign(&self) -> f64 {
        match self.spindle.sense {
            None => 0.0,
            Some(Sense::Clockwise) => 1.0,
            Some(Sense::Counterclockwise) => -1.0,
        }
    }

    fn path_mode(&self, corners: Corners, merge: Option<f64>) -> PathMode {
        let stated = |v: f64| (v > 0.0).then(|| Length::mm(v * self.mm()));
        match corners {
            Corners::ExactPath => PathMode::Exact,
            Corners::ExactStop => PathMode::ExactStop,
            Corners::Continuous(tolerance) => {
                PathMode::Blend { tolerance: stated(tolerance), merge: merge.and_then(stated) }
            }
        }
    }

    /// Modes and offsets: nothing to machine yet.
    pub(crate) fn mode(&mut self, call: &Call<'_>) {
        match call {
            Call::UseUnits(units) => self.units = *units,
            Call::WorkOffset(system, offset) => {
                self.frame.origin = self.in_mm(*offset);
                self.work_offset = *system;
            }
            Call::AddedOffset(offset) => self.frame.added = self.in_mm(*offset),
            Call::ToolOffset(offset) => self.frame.tool = self.in_mm(*offset),
            Call::Rotation(degrees) => self.frame.rotate(*degrees),
            Call::FeedMode { per_revolution } => self.feed.per_revolution = *per_revolution,
            Call::FeedRate { rate, duration_s } => {
                self.feed.rate = *rate;
                self.feed.mm = self.mm();
                self.feed.duration_s = *duration_s;
            }
            Call::PathControl { corners, merge } => self.path = self.path_mode(*corners, *merge),
            _ => {}
        }
    }
}

/// A point in mm and degrees as a position.
pub(crate) fn position(point: &Point) -> Position {
    let [x, y, z, a, b, c, u, v, w] = *point;
    Position {
        linear: [x, y, z].map(Length::mm),
        rotary: [a, b, c].map(Angle::deg),
        parallel: [u, v, w].map(Length::mm),
    }
}

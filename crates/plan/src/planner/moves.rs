//! Rapids and cuts: judged, bounded, and handed to the run that joins them.
use super::contact::Sweep;
use super::refuse::clipped;
use super::{Job, NOTHING, Planner};
use crate::along::{Along, along};
use crate::run::{Alone, OrderedMove};
use crate::{Step, StepKind};
use alloc::format;
use alloc::vec::Vec;
use canon::{Axis, Feed, PathMode, Position, Spline};
use diag::Diagnostic;
use motion::{Move, Path, coordinate};
use path::geometry::Segment;
use path::geometry::quintic;
use units::{Coordinate, Length, Spin};

/// Share of P for merging collinear moves, where no Q below P is stated, and the most of it that Q
/// may take: what merging takes is missing where the curve through the points is made faster.
const MERGED: f64 = 0.02;
const MERGED_MOST: f64 = 0.3;

impl Planner {
    pub(super) fn rapid(&mut self, job: &mut Job, to: &Position) {
        self.leave_change_position(job, to);
        let from = self.position();
        let reversed = self.reversed_along.take();
        let is_back = reversed.is_some_and(|axis| to.with(axis, from.along(axis)) == from);
        if reversed.is_some() && !is_back {
            self.tell_spindles(job);
        }
        self.arrive(to);
        let path = Path::Line { from, to: self.position() };
        if self.is_refused(job, &[path]) {
            return;
        }
        self.sweep(job, &path, Sweep::Rapid);
        if !is_back {
            return self.rapid_along(job, path);
        }
        // out of the work first, and only then forward again
        if let Some(step) = self.rapid_step(job, path) {
            self.hand_on(job, step.kind);
        }
        self.tell_spindles(job);
    }

    /// A rapid that has been judged; after a spindle order that is still open. Where paths are
    /// blended it is a part of them.
    pub(super) fn rapid_along(&mut self, job: &mut Job, path: Path) {
        let busy = self.is_open()
            || self.outbox.is_waiting()
            || self.spindles.iter().any(|state| state.throwing || state.surface.is_some());
        if self.joins_rapids() && !busy {
            let Some(bound) = self.bound(job, &path, true, f64::INFINITY) else { return };
            if !self.motion_is_refused(job, &bound, path.length(), bound.speed) {
                let alone = Alone::PerTime(bound.speed);
                self.run_on(job, path, bound, alone, (f64::INFINITY, true));
                self.stop_exactly(job);
            }
        } else if let Some(step) = self.rapid_step(job, path) {
            self.after_spindle(job, step);
        }
    }

    pub(super) fn rapid_step(&mut self, job: &Job, path: Path) -> Option<Step> {
        let length = path.length();
        let bound = self.bound(job, &path, true, f64::INFINITY)?;
        let profile = bound.profile(length, bound.speed);
        if self.profile_is_refused(job, &profile, 1.0) {
            return None;
        }
        let rapid = Move {
            path,
            profile,
            rapid: true,
            per_revolution: false,
            exact_stop: true,
            floats: false,
            programmed: None,
        };
        Some(job.step(StepKind::Move(rapid.into())))
    }

    /// A cutting move; `make` builds its path from where the axes are.
    pub(super) fn cut(
        &mut self,
        job: &mut Job,
        to: &Position,
        feed: Feed,
        make: impl FnOnce(Position) -> Path,
    ) {
        self.come_down(job);
        let path = make(self.programmed);
        self.programmed = *to;
        if self.may_cut(job, &[path], feed) {
            self.sweep(job, &path, Sweep::Feed(feed));
            self.cut_along(job, path, feed);
            self.stop_exactly(job);
        }
    }

    /// Along a curve, whose parts each are one polynomial of their length; the last of them ends
    /// it.
    pub(super) fn spline(&mut self, job: &mut Job, to: &Position, spline: &Spline, feed: Feed) {
        self.come_down(job);
        let mut from = self.programmed;
        let mut parts = Vec::new();
        for piece in &spline.pieces {
            let place = |[x, y]: [Length; 2]| {
                from.with(Axis::X, Coordinate::linear(x)).with(Axis::Y, Coordinate::linear(y))
            };
            let [a, b, c, d, end] = piece.map(place);
            let control = [from, a, b, c, d, end];
            let control = control.map(|at| Axis::ALL.map(|axis| coordinate(&at, axis)));
            quintic(control, &mut parts);
            from = end;
        }
        let mut from = self.programmed;
        let paths: Vec<Path> = parts
            .into_iter()
            .map(|curve| {
                let [x, y, ..] = curve.control[5].map(Length::mm);
                let to =
                    from.with(Axis::X, Coordinate::linear(x)).with(Axis::Y, Coordinate::linear(y));
                Path::Spline { from: core::mem::replace(&mut from, to), to, curve }
            })
            .collect();
        self.programmed = *to;
        if self.may_cut(job, &paths, feed) {
            let length: f64 = paths.iter().map(Path::length).sum();
            for path in paths {
                // a time to take is that of all parts together
                let feed = match feed {
                    Feed::Duration(time) => Feed::Duration(time * (path.length() / length)),
                    Feed::PerTime(_) | Feed::PerRevolution(_) => feed,
                };
                self.sweep(job, &path, Sweep::Feed(feed));
                self.cut_along(job, path, feed);
            }
            self.stop_exactly(job);
        }
    }

    /// Whether the axes can go there, and at such a feed; said where not.
    fn may_cut(&mut self, job: &Job, paths: &[Path], feed: Feed) -> bool {
        let turning = self.turning();
        let refused = self.is_refused(job, paths);
        !self.feed_is_refused(job, feed, turning) && !refused
    }

    /// How fast the spindle is to turn.
    /// With G96 the limit: motion by turns is planned for the fastest of them.
    fn turning(&self) -> Spin {
        self.spindles.first().map_or(Spin::ZERO, |s| s.surface.map_or(s.ordered.abs(), |s| s.limit))
    }

    /// At rest before the next move, if the program wants that.
    fn stop_exactly(&mut self, job: &mut Job) {
        if matches!(self.mode, PathMode::ExactStop) && !self.only_judges {
            self.outbox.end_run(&self.limits, job.emit);
        }
    }

    fn cut_along(&mut self, job: &mut Job, path: Path, feed: Feed) {
        let (length, n) = (path.length(), self.turning().value());
        let wanted = match feed {
            Feed::PerTime(speed) => speed.value(),
            Feed::PerRevolution(lead) => lead.value() * n,
            Feed::Duration(time) => length / time.value(),
        };
        let Some(bound) = self.bound(job, &path, false, wanted) else { return };
        if wanted > bound.axis_speed * (1.0 + 1e-9) {
            let feeds = (wanted, bound.axis_speed);
            self.findings.add_once(clipped(job.span, &path, feeds, &self.frame));
        }
        if self.motion_is_refused(job, &bound, length, wanted) {
            return;
        }
        self.tell_spindles(job);
        self.await_spindles(job);
        let alone = match feed {
            Feed::PerTime(_) => Alone::PerTime(wanted),
            Feed::PerRevolution(lead) => Alone::PerRevolution(lead.value(), n),
            Feed::Duration(time) => Alone::Lasting(time.value()),
        };
        let along = match alone {
            Alone::PerRevolution(lead, _) => lead,
            Alone::PerTime(_) | Alone::Lasting(_) => wanted,
        };
        self.run_on(job, path, bound, alone, (along, false));
    }

    /// Go on with a move: `feed` per second or revolution, and whether it is a rapid.
    pub(super) fn run_on(
        &mut self,
        job: &mut Job,
        path: Path,
        bound: Along,
        alone: Alone,
        (feed, rapid): (f64, bool),
    ) {
        if bound.speed > 0.0 {
            let time = path.length() / bound.speed;
            self.outbox.heat.passes(time);
        }
        if self.only_judges {
            return;
        }
        let (tolerance, merge) = self.joined_within();
        let (op, line) = (job.index, job.span.line);
        let segment = Segment { curve: path.curve(), feed, rapid, tolerance, merge, op, line };
        let order = OrderedMove { segment, path, bound, alone };
        self.outbox.run_on(order, self.wanted, &self.limits, job.emit);
        if let Some((line, why)) = self.outbox.take_refusal() {
            let text = format!("line {line}: {why}");
            self.findings.add(Diagnostic::error("M0316", job.span, text));
        }
    }

    /// Rapids are part of a blended path where a tolerance is stated: by G64 P, or by the machine
    /// for programs that say nothing.
    pub(super) fn joins_rapids(&self) -> bool {
        let PathMode::Blend { tolerance, .. } = self.mode else { return false };
        let always = matches!(self.limits.joining.mode, PathMode::Blend { .. });
        (always || tolerance.is_some()) && self.joined_within().0 > 0.0
    }

    /// How far the joined path may be from the programmed one, and how far merged points from their
    /// line.
    pub(super) fn joined_within(&self) -> (f64, f64) {
        let PathMode::Blend { tolerance, merge } = self.mode else { return (0.0, 0.0) };
        let whole = tolerance.unwrap_or(self.limits.joining.tolerance).value().max(0.0);
        let stated = merge.map(Length::value).filter(|q| *q < whole);
        let merge = stated.map_or(MERGED * whole, |q| q.clamp(0.0, MERGED_MOST * whole));
        (whole - merge, merge)
    }

    /// Limits along a path; `None` if there is nothing to move, or an axis is missing, which is a
    /// finding.
    pub(super) fn bound(
        &mut self,
        job: &Job,
        path: &Path,
        rapid: bool,
        wanted: f64,
    ) -> Option<Along> {
        if path.length() < NOTHING {
            return None;
        }
        match along(path, &self.limits, rapid, wanted) {
            Ok(bound) => Some(bound),
            Err(axis) => {
                self.findings.add_missing_axis(job.span, axis);
                // what follows does not begin where the motion planned so far ends
                self.only_judges = true;
                None
            }
        }
    }
}

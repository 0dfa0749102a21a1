//! The way of the tool's tip through a program, as polylines: what a picture of the path is drawn
//! from.
//!
//! Operations have machine coordinates of the axes. Of them the tip in the work offset in force is
//!
//! ```text
//!   tip = axis − zero of the work offset,    along Z less the length of the tool in the spindle
//! ```
use canon::{Arc, Axis, Op, OpKind, Position, Spline};
use units::{Angle, Coordinate};

/// Points that are kept: what a browser draws at once. A longer program is shown up to there.
const MOST_POINTS: usize = 200_000;
/// An arc is drawn with a chord for each such part of it.
const CHORD: Angle = Angle::deg(6.0);
/// An arc of more turns is drawn with chords that are longer.
const MOST_CHORDS: usize = 720;

/// What a piece of the way is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathKind {
    /// As fast as the axes allow.
    Rapid,
    /// At a feed.
    Feed,
    /// A tap, in and out.
    Tap,
    /// A turned thread.
    Thread,
    /// Until a probe touches.
    Probe,
}

/// A piece of the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// The program's line.
    pub line: u32,
    /// What it is for.
    pub kind: PathKind,
    /// Places of the tip, mm; the first is where the piece before it has ended.
    pub points: Vec<[f64; 3]>,
}

/// A hole or a thread that is tapped.
#[derive(Clone, Debug, PartialEq)]
pub struct PathHole {
    /// The program's line.
    pub line: u32,
    /// It is tapped.
    pub is_tap: bool,
    /// Over it, at the R plane.
    pub at: [f64; 3],
    /// Its programmed depth, along Z.
    pub bottom: f64,
}

/// The way through a program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolPath {
    /// In the program's order.
    pub segments: Vec<Segment>,
    /// What is drilled and tapped, in the program's order.
    pub holes: Vec<PathHole>,
    /// The program is longer than this.
    pub is_shortened: bool,
}

/// Where the tip is for axes at a place.
struct TipFrame<'a> {
    zero: [f64; 3],
    length: f64,
    length_of: &'a dyn Fn(u32) -> f64,
}

impl TipFrame<'_> {
    fn tip(&self, at: &Position) -> [f64; 3] {
        let mut tip = [Axis::X, Axis::Y, Axis::Z].map(|axis| at.along(axis).value());
        for (value, zero) in tip.iter_mut().zip(self.zero) {
            *value -= zero;
        }
        tip[2] -= self.length;
        tip
    }
}

impl ToolPath {
    /// Of operations that begin where the axes stand, with this tool's length in the spindle;
    /// `length_of` is asked for that of each tool that is changed to.
    pub fn of<'a>(
        ops: impl IntoIterator<Item = &'a Op>,
        start: Position,
        zero: [f64; 3],
        length: f64,
        length_of: &dyn Fn(u32) -> f64,
    ) -> Self {
        let mut path = Self::default();
        let mut frame = TipFrame { zero, length, length_of };
        let (mut at, mut count) = (start, 0);
        for op in ops {
            if count > MOST_POINTS {
                path.is_shortened = true;
                break;
            }
            count += path.push(op, &mut at, &mut frame);
        }
        path
    }

    /// The next operation; how many points it has.
    fn push(&mut self, op: &Op, at: &mut Position, frame: &mut TipFrame<'_>) -> usize {
        let line = op.span.line;
        let from = frame.tip(at);
        let (kind, to, way) = match &op.kind {
            OpKind::ChangeTool { number } => {
                frame.length = (frame.length_of)(*number);
                return 0;
            }
            OpKind::Hole(hole) => {
                let bottom =
                    frame.tip(&hole.at.with(hole.axis, Coordinate::linear(hole.bottom)))[2];
                self.holes.push(PathHole { line, is_tap: false, at: frame.tip(&hole.at), bottom });
                return 1;
            }
            OpKind::Tap(tap) => {
                let (top, bottom) = (
                    frame.tip(&tap.start),
                    frame.tip(&tap.start.with(tap.axis, Coordinate::linear(tap.bottom))),
                );
                self.holes.push(PathHole { line, is_tap: true, at: top, bottom: bottom[2] });
                (PathKind::Tap, tap.start, vec![top, bottom, top])
            }
            OpKind::Rapid { to } => (PathKind::Rapid, *to, vec![frame.tip(to)]),
            OpKind::Line { to, .. } => (PathKind::Feed, *to, vec![frame.tip(to)]),
            OpKind::Arc { to, arc, .. } => (PathKind::Feed, *to, chords(at, to, arc, frame)),
            OpKind::Spline { to, spline, .. } => (PathKind::Feed, *to, ends(at, to, spline, frame)),
            OpKind::Threading(thread) => (PathKind::Thread, thread.to, vec![frame.tip(&thread.to)]),
            OpKind::Probe(probe) => (PathKind::Probe, probe.to, vec![frame.tip(&probe.to)]),
            _ => return 0, // moves nothing
        };
        *at = to;
        let count = way.len();
        match self.segments.last_mut() {
            Some(last) if last.line == line && last.kind == kind && kind != PathKind::Tap => {
                last.points.extend(way);
            }
            _ => {
                let mut points = vec![from];
                points.extend(way);
                self.segments.push(Segment { line, kind, points });
            }
        }
        count
    }
}

/// Chords of an arc.
fn chords(from: &Position, to: &Position, arc: &Arc, frame: &TipFrame<'_>) -> Vec<[f64; 3]> {
    let [first, second, normal] = arc.plane.axes();
    let count = ((arc.sweep.value() / CHORD.value()).abs().ceil() as usize).clamp(1, MOST_CHORDS);
    let [x, y] = [first, second].map(|axis| from.along(axis).of_linear());
    let (dx, dy) = ((x - arc.centre[0]).value(), (y - arc.centre[1]).value());
    let mut points: Vec<_> = (1..count)
        .map(|k| {
            let share = k as f64 / count as f64;
            let (sin, cos) = (arc.sweep.value() * core::f64::consts::TAU * share).sin_cos();
            let place = to
                .with(
                    first,
                    Coordinate::linear(arc.centre[0] + units::Length::mm(cos * dx - sin * dy)),
                )
                .with(
                    second,
                    Coordinate::linear(arc.centre[1] + units::Length::mm(sin * dx + cos * dy)),
                )
                .with(normal, from.along(normal) * (1.0 - share) + to.along(normal) * share);
            frame.tip(&place)
        })
        .collect();
    points.push(frame.tip(to));
    points
}

/// Where the curves of a spline, which are short, meet.
fn ends(from: &Position, to: &Position, spline: &Spline, frame: &TipFrame<'_>) -> Vec<[f64; 3]> {
    let count = spline.pieces.len();
    let inner = spline.pieces.iter().take(count.saturating_sub(1));
    let mut points: Vec<_> = inner
        .map(|piece| {
            frame.tip(
                &from
                    .with(Axis::X, Coordinate::linear(piece[4][0]))
                    .with(Axis::Y, Coordinate::linear(piece[4][1])),
            )
        })
        .collect();
    points.push(frame.tip(to));
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::{Feed, Plane};
    use units::{Length, Speed};

    fn op(line: u32, kind: OpKind) -> Op {
        Op { span: canon::Span { line, ..canon::Span::default() }, kind }
    }

    #[test]
    fn the_tip_is_the_axis_less_the_zero_of_the_work_and_the_length_of_the_tool() {
        let ops = [
            op(1, OpKind::ChangeTool { number: 3 }),
            op(2, OpKind::Rapid { to: Position::xyz(-100.0, -50.0, -150.0) }),
        ];
        let zero = [-110.0, -60.0, -300.0];
        let path = ToolPath::of(&ops, Position::default(), zero, 0.0, &|number| {
            assert_eq!(number, 3);
            120.0
        });
        assert_eq!(path.segments.len(), 1);
        assert_eq!(path.segments[0].points[1], [10.0, 10.0, 30.0]);
        assert!(!path.is_shortened);
    }

    #[test]
    fn the_chords_of_a_quarter_of_a_circle_lie_on_it() {
        let arc = Arc { plane: Plane::XY, centre: [Length::ZERO; 2], sweep: Angle::deg(90.0) };
        let feed = Feed::PerTime(Speed::mm_per_min(500.0));
        let ops = [op(1, OpKind::Arc { to: Position::xyz(0.0, 10.0, 0.0), arc, feed })];
        let path = ToolPath::of(&ops, Position::xyz(10.0, 0.0, 0.0), [0.0; 3], 0.0, &|_| 0.0);
        let points = &path.segments[0].points;
        assert_eq!(points.len(), 1 + 15);
        for [x, y, _] in points {
            assert!((x.hypot(*y) - 10.0).abs() < 1e-9, "{x} {y}");
            assert!(*x >= -1e-9 && *y >= -1e-9, "the quarter between +X and +Y: {x} {y}");
        }
    }
}

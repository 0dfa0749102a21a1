//! Where a polygon is cut, from the operations that follow its beginning.
//!
//! ```text
//!   G51.2 ─ G1 ─ G1 ─ G50.2      at: the deepest of these cuts, for which the swing is computed
//!   G51.2 ─ G1 ─ G50.2           finished: the deepest of all over the same heights, which leaves the form
//! ```
use canon::{Op, OpKind, Position};
use units::Length;

/// A polygon's place, machine coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolygonDepths {
    /// X and Y of the deepest cut before the gear is let go.
    pub at: [Length; 2],
    /// The least X at which the same heights are cut, then or later.
    pub finished: Length,
}

/// A straight cut while the spindles are geared.
struct Segment {
    ends: [Position; 2],
    /// Before the gear is let go.
    own: bool,
}

impl Segment {
    fn deepest(&self) -> [Length; 2] {
        let [a, b] = self.ends.map(|end| [end.linear[0], end.linear[1]]);
        if a[0] < b[0] { a } else { b }
    }

    /// Lowest and highest Z.
    fn heights(&self) -> [Length; 2] {
        let [a, b] = self.ends.map(|end| end.linear[2]);
        if a < b { [a, b] } else { [b, a] }
    }

    fn is_as_high_as(&self, other: &Self) -> bool {
        let ([low, high], [from, to]) = (self.heights(), other.heights());
        low <= to && from <= high
    }
}

/// The cuts of a polygon, by what follows the operation that begins it; `None`: nothing is cut.
pub fn cut<'o>(following: impl Iterator<Item = &'o Op>) -> Option<PolygonDepths> {
    let all = segments(following);
    let deeper =
        |a: &&Segment, b: &&Segment| a.deepest()[0].value().total_cmp(&b.deepest()[0].value());
    let own = all.iter().filter(|segment| segment.own).min_by(deeper)?;
    let last = all.iter().filter(|segment| segment.is_as_high_as(own)).min_by(deeper);
    Some(PolygonDepths { at: own.deepest(), finished: last.unwrap_or(own).deepest()[0] })
}

fn segments<'o>(following: impl Iterator<Item = &'o Op>) -> Vec<Segment> {
    let (mut geared, mut own) = (true, true);
    let mut at: Option<Position> = None;
    let mut all = Vec::new();
    for op in following {
        match &op.kind {
            OpKind::Rapid { to } | OpKind::Arc { to, .. } => at = Some(*to),
            OpKind::Line { to, .. } => {
                if geared {
                    all.push(Segment { ends: [at.unwrap_or(*to), *to], own });
                }
                at = Some(*to);
            }
            OpKind::Polygon(_) => (geared, own) = (true, false),
            OpKind::PolygonEnd => (geared, own) = (false, false),
            OpKind::End => break,
            _ => {} // nothing else says where it is cut
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::{Feed, Span};
    use units::Speed;

    const LINE: fn(f64, f64) -> OpKind = |x, z| OpKind::Line {
        to: Position::xyz(x, 0.0, z),
        feed: Feed::PerTime(Speed::mm_per_s(1.0)),
    };
    const RAPID: fn(f64, f64) -> OpKind = |x, z| OpKind::Rapid { to: Position::xyz(x, 0.0, z) };

    #[track_caller]
    fn check(kinds: &[OpKind], at: f64, finished: f64) {
        let span = Span { file: 0, line: 1, start: 0, end: 0 };
        let ops: Vec<Op> = kinds.iter().map(|kind| Op { span, kind: kind.clone() }).collect();
        let found = cut(ops.iter()).expect("something is cut");
        assert_eq!((found.at[0], found.finished), (Length::mm(at), Length::mm(finished)));
    }

    #[test]
    fn of_several_passes_the_deepest_counts() {
        let passes = [
            RAPID(60.0, 2.0),
            LINE(60.0, -5.0),
            RAPID(70.0, 2.0),
            RAPID(58.5, 2.0),
            LINE(58.5, -5.0),
            LINE(59.5, -5.0),
            OpKind::PolygonEnd,
        ];
        check(&passes, 58.5, 58.5);
    }

    #[test]
    fn a_later_pass_at_the_same_height_finishes_it_and_one_below_does_not() {
        let polygon = || [RAPID(60.0, 2.0), LINE(60.0, -5.0), OpKind::PolygonEnd];
        let again = OpKind::Polygon(canon::Polygon {
            work: 0,
            tool: 1,
            ratio: canon::Ratio { follower: 2, master: 1 },
            phase: units::Angle::ZERO,
            oscillations: Vec::new(),
            auto: None,
            by_distance: Vec::new(),
            wanted: Vec::new(),
            compensated: false,
            zero: canon::Position::default(),
            own_zero: None,
        });
        let with = |from: f64, to: f64| {
            let then = [again.clone(), RAPID(58.5, from), LINE(58.5, to), OpKind::End];
            polygon().into_iter().chain(then).collect::<Vec<_>>()
        };
        check(&with(2.0, -5.0), 60.0, 58.5);
        check(&with(-6.0, -9.0), 60.0, 60.0);
    }

    #[test]
    fn a_cut_after_the_gear_is_let_go_is_none_of_it() {
        check(&[LINE(60.0, -5.0), OpKind::PolygonEnd, LINE(10.0, -5.0)], 60.0, 60.0);
    }
}

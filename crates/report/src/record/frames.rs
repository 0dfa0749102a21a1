//! How the program wrote each of its operations: work offset, units, rotation.
//!
//! Operations carry machine coordinates. What a reader wants to see is the place in the work offset
//! that was in force when the feature was programmed: a plate in the second vice has its holes in
//! G55.
use canon::{LengthUnit, OpKind, Position, ProgramFrame};
use units::{Angle, Length};

/// Different frames that are kept; later ones count as the last of them.
const FRAMES: usize = 4096;
/// Changes from one to another that are kept.
const CHANGES: usize = 1 << 20;

/// Frames by operation, in a room that does not grow without end.
#[derive(Clone, Debug, Default)]
pub(crate) struct Frames {
    /// Each once, and whether something was cut in it.
    known: Vec<(ProgramFrame, bool)>,
    /// From this operation on, this one of them.
    changes: Vec<(u32, u16)>,
    /// The operation that was announced last cuts.
    cuts: bool,
}

impl Frames {
    /// An operation is announced.
    pub(crate) const fn op(&mut self, kind: &OpKind) {
        self.cuts = matches!(
            kind,
            OpKind::Line { .. }
                | OpKind::Arc { .. }
                | OpKind::Spline { .. }
                | OpKind::Tap(_)
                | OpKind::Hole(_)
                | OpKind::Threading(_)
                | OpKind::Polygon(_)
                | OpKind::Hob(_)
                | OpKind::Cam(_)
        );
    }

    /// It was written in this frame.
    pub(crate) fn put(&mut self, op: u32, frame: ProgramFrame) {
        // recorded places are those of the tip: the tool's length is no part of them
        let frame = ProgramFrame { tool: Position::default(), ..frame };
        let at = self.known.iter().position(|(known, _)| *known == frame).unwrap_or_else(|| {
            if self.known.len() < FRAMES {
                self.known.push((frame, false));
            }
            self.known.len() - 1
        });
        if let Some((_, cut)) = self.known.get_mut(at) {
            *cut |= self.cuts;
        }
        let number = u16::try_from(at).unwrap_or(u16::MAX); // FRAMES fits
        let changes = self.changes.last().is_none_or(|(_, last)| *last != number);
        if changes && self.changes.len() < CHANGES {
            self.changes.push((op, number));
        }
    }

    /// The frame of an operation; `None`: the interpreter has not reported one.
    pub(crate) fn of(&self, op: u32) -> Option<&ProgramFrame> {
        let after = self.changes.partition_point(|(from, _)| *from <= op);
        let (_, number) = self.changes.get(after.checked_sub(1)?)?;
        self.known.get(usize::from(*number)).map(|(frame, _)| frame)
    }

    /// The one in which everything was cut, if there is only one.
    pub(crate) fn only(&self) -> Option<&ProgramFrame> {
        let mut cut = self.known.iter().filter(|(_, cut)| *cut).map(|(frame, _)| frame);
        let first = cut.next()?;
        cut.next().is_none().then_some(first)
    }

    /// The unit in which lengths were first written for a cut.
    pub(crate) fn unit(&self) -> Option<LengthUnit> {
        self.known.iter().find(|(_, cut)| *cut).map(|(frame, _)| frame.unit)
    }
}

/// What a frame is called.
pub(crate) fn name(frame: &ProgramFrame) -> String {
    let offset = match (frame.work_offset_code(), frame.work_offset) {
        (Some(code), _) => code.to_owned(),
        (None, 0) => "machine coordinates".to_owned(),
        (None, more) => format!("G54.1 P{}", more.saturating_sub(9)),
    };
    let shift = if frame.added == Position::default() { "" } else { " with G52 or G92" };
    let turn = match frame.rotation {
        Angle::ZERO => String::new(),
        rotation => format!(" turned by {}°", crate::svg::fixed(rotation.in_deg(), 2)),
    };
    offset + shift + &turn
}

/// X and Y of a machine position in a frame, mm.
pub(crate) fn within(frame: &ProgramFrame, at: [Length; 2]) -> [f64; 2] {
    let from = [0, 1].map(|i| (at[i] - frame.origin.linear[i]).value());
    let (sine, cosine) = frame.rotation.in_rad().sin_cos();
    let turned = [from[0] * cosine + from[1] * sine, from[1] * cosine - from[0] * sine];
    [0, 1].map(|i| turned[i] - frame.added.linear[i].value())
}

/// Where its zero lies in machine coordinates, if its axes are parallel to the machine's.
pub(crate) fn zero(frame: &ProgramFrame) -> Option<Position> {
    (frame.rotation == Angle::ZERO).then(|| {
        let mut at = frame.origin;
        for (place, more) in at.linear.iter_mut().zip(frame.added.linear) {
            *place += more;
        }
        at
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::Feed;
    use units::Speed;

    fn cut() -> OpKind {
        OpKind::Line { to: Position::default(), feed: Feed::PerTime(Speed::mm_per_s(1.0)) }
    }

    fn frame(work_offset: u8, x: f64) -> ProgramFrame {
        ProgramFrame { work_offset, origin: Position::xyz(x, 0.0, 0.0), ..ProgramFrame::default() }
    }

    #[test]
    fn each_operation_is_told_in_the_offset_in_which_it_was_written() {
        let mut frames = Frames::default();
        for (op, offset) in [(0, 1), (1, 1), (2, 2), (3, 2), (4, 1)] {
            frames.op(&cut());
            frames.put(op, frame(offset, 100.0 * f64::from(offset)));
        }
        let names: Vec<_> = (0..5).filter_map(|op| frames.of(op)).map(name).collect();
        assert_eq!(names, ["G54", "G54", "G55", "G55", "G54"]);
        assert_eq!(frames.only(), None);
        assert_eq!(within(&frame(2, 200.0), [Length::mm(210.0), Length::mm(5.0)]), [10.0, 5.0]);
    }

    #[test]
    fn an_offset_in_which_nothing_is_cut_does_not_count() {
        let mut frames = Frames::default();
        frames.op(&OpKind::Rapid { to: Position::default() });
        frames.put(0, frame(1, 0.0));
        frames.op(&cut());
        frames.put(1, frame(11, 40.0));
        assert_eq!(frames.only().map(name), Some("G54.1 P2".into()));
    }

    #[test]
    fn a_turned_frame_turns_places_back() {
        let turned = ProgramFrame { rotation: Angle::deg(90.0), ..frame(1, 0.0) };
        let [x, y] = within(&turned, [Length::mm(0.0), Length::mm(10.0)]);
        assert!((x - 10.0).abs() < 1e-12 && y.abs() < 1e-12, "{x} {y}");
        assert_eq!((zero(&turned), name(&turned)), (None, "G54 turned by 90.00°".into()));
    }
}

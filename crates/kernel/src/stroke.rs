//! A planned stroke as the tapping cycle reads it: revolutions over time.
//!
//! ```text
//!   v │    ______           pieces of constant jerk; the time asked for only ever goes on, so the
//!     │  ╱│      │╲         piece found last is where the next search begins
//!     │╱  │      │ ╲_
//!     └───┴──────┴────► t
//!                ▲ brake: from here on the speed only falls
//! ```
use core::cell::Cell;
use motion::Profile;
use sync::{Stroke, StrokePoint};
use units::{Angle, Spin, SpinAccel, Time};

/// Where a search begins: piece, and the time at which it begins.
pub(crate) type Mark = Cell<(usize, f64)>;

/// A profile and where it was read last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Planned<'a> {
    pub(crate) profile: &'a Profile,
    pub(crate) mark: &'a Mark,
}

impl Stroke for Planned<'_> {
    fn at(&self, time: Time) -> StrokePoint {
        let (mut index, mut start) = self.mark.get();
        let t = time.value().max(0.0);
        if t < start {
            (index, start) = (0, 0.0);
        }
        let pieces = self.profile.pieces();
        while let Some(piece) = pieces.get(index) {
            if t < start + piece.duration {
                self.mark.set((index, start));
                return point(&piece.at(t - start));
            }
            start += piece.duration;
            index += 1;
        }
        // over: at rest at the end, whatever rounding the last piece left in speed and acceleration
        StrokePoint { turned: self.length(), ..StrokePoint::default() }
    }

    fn duration(&self) -> Time {
        Time::s(self.profile.duration())
    }

    fn length(&self) -> Angle {
        Angle::rev(self.profile.end().s)
    }

    fn brake(&self) -> Time {
        let mut at = self.profile.duration();
        for piece in self.profile.pieces().iter().rev() {
            // a piece that begins by gaining speed, or ends without having lost any, is not braking
            // yet
            if piece.a > 0.0 || piece.end().v >= piece.v {
                break;
            }
            at -= piece.duration;
        }
        Time::s(at)
    }
}

fn point(at: &motion::Instant) -> StrokePoint {
    StrokePoint {
        turned: Angle::rev(at.s),
        spin: Spin::rev_per_s(at.v),
        accel: SpinAccel::rev_per_s2(at.a),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use motion::Phase;

    /// 0.1 s up, 0.1 s at 10 rev/s, 0.1 s down.
    fn trapezoid() -> Profile {
        let mut profile = Profile::EMPTY;
        for (s, v, a) in [(0.0, 0.0, 100.0), (0.5, 10.0, 0.0), (1.5, 10.0, -100.0)] {
            assert!(profile.push(Phase { duration: 0.1, s, v, a, j: 0.0 }));
        }
        profile
    }

    #[test]
    fn it_reads_as_the_profile_itself_in_any_order_of_times() {
        let profile = trapezoid();
        let mark = Mark::default();
        let stroke = Planned { profile: &profile, mark: &mark };
        for t in [0.0, 0.05, 0.15, 0.149, 0.25, 0.01, 0.299, 0.2, -1.0] {
            assert!((stroke.at(Time::s(t)).turned.value() - profile.at(t).s).abs() < 1e-12, "{t}");
        }
        assert_eq!(stroke.at(Time::s(0.4)).turned, Angle::rev(2.0));
    }

    #[test]
    fn braking_begins_where_the_speed_falls_for_good() {
        let profile = trapezoid();
        let stroke = Planned { profile: &profile, mark: &Mark::default() };
        assert!((stroke.brake().value() - 0.2).abs() < 1e-12);
    }
}

//! Stretches of constant s⃛ along one piece: how they are made, joined and searched.
use super::cell::{LimitRow, Rows};
use crate::{Instant, Phase};

/// A phase and the one after it as one: the same time, and place and speed at its end. What lies
/// between differs, by acceleration too, so it is for phases much shorter than a servo period.
/// `None` where the speed changes too much for that.
pub fn merged(phase: &Phase, next: &Phase) -> Option<Phase> {
    let duration = phase.duration + next.duration;
    let Instant { s, v, .. } = next.at(next.duration);
    let least = phase.v.min(v);
    // s and v at the end, by a and j
    let way = (s - phase.s - phase.v * duration) / (duration * duration);
    let change = (v - phase.v) / duration;
    let (a, j) = (6.0 * way - 2.0 * change, 6.0 * (change - 2.0 * way) / duration);
    let evenly = a.abs().max((a + j * duration).abs()) * duration < EVEN * least;
    evenly.then_some(Phase { duration, s: phase.s, v: phase.v, a, j })
}

/// When a phase is at `s`, which lies on it: by Newton's method, within bounds that close in.
pub(super) fn time_at(phase: &Phase, s: f64) -> f64 {
    let [mut low, mut high] = [0.0, phase.duration];
    let mut t = phase.duration * ((s - phase.s) / (phase.end().s - phase.s)).clamp(0.0, 1.0);
    for _ in 0..64 {
        let Instant { s: at, v, .. } = phase.at(t);
        if at < s {
            low = t;
        } else {
            high = t;
        }
        let next = t - (at - s) / v;
        let next = if next > low && next < high { next } else { f64::midpoint(low, high) };
        if (next - t).abs() <= f64::EPSILON * phase.duration {
            return next;
        }
        t = next;
    }
    t
}

/// A phase, and the piece along which it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timed {
    /// Number of the piece, counted from the first that was pushed, 0.
    pub piece: u64,
    /// The phase.
    pub phase: Phase,
}

/// Phases are merged where their speed changes by less than this share of it.
const EVEN: f64 = 0.25;
/// Shorter phases are rounding, s.
const SHORTEST: f64 = 1e-13;

/// Phases of constant s̈ over a line that is begun with ṡ² = `b0` and ended with `b1`.
pub(crate) fn over_line(
    h: f64,
    accel: f64,
    cap: f64,
    b0: f64,
    b1: f64,
    mut give: impl FnMut(Phase),
) {
    let (mut at, mut b) = (0.0, b0);
    let mut ramp = |at: &mut f64, b: &mut f64, to: f64, length: f64| {
        let (v0, v1) = (libm::sqrt(*b), libm::sqrt(to));
        let duration = 2.0 * length / (v0 + v1);
        if duration > SHORTEST && duration.is_finite() {
            give(Phase { duration, s: *at, v: v0, a: (v1 - v0) / duration, j: 0.0 });
            *at += length;
        }
        *b = to;
    };
    if b > cap {
        // a feed that was lowered on the way
        let to = cap.max(b1);
        let length = ((b - to) / (2.0 * accel)).min(h);
        ramp(&mut at, &mut b, to, length);
    }
    let left = h - at;
    let top = (f64::midpoint(b, b1) + accel * left).min(cap).max(b).max(b1);
    let (up, down) = ((top - b) / (2.0 * accel), (top - b1) / (2.0 * accel));
    let up = up.min(left);
    let down = down.min(left - up);
    ramp(&mut at, &mut b, top, up);
    ramp(&mut at, &mut b, top, left - up - down);
    ramp(&mut at, &mut b, b1, down);
}

/// Phases over a line from rest to rest, with limits of acceleration and jerk that are finite, and
/// of ṡ².
///
/// With the highest speed v: a ramp takes v/a + a/j, or 2·√(v/j) where a is never reached, over
/// half of v times that.
pub(crate) fn from_rest_to_rest(
    h: f64,
    accel: f64,
    jerk: f64,
    cap: f64,
    mut give: impl FnMut(Phase),
) {
    let half = accel * accel / (2.0 * jerk);
    let level = accel * h / (libm::sqrt(half * half + accel * h) + half);
    let third = libm::cbrt(h * libm::sqrt(jerk) / 2.0);
    let peak = if level >= 2.0 * half { level } else { third * third };
    let v = peak.min(libm::sqrt(cap));
    let (rise, hold) = if v > 2.0 * half {
        (accel / jerk, v / accel - accel / jerk)
    } else {
        (libm::sqrt(v / jerk), 0.0)
    };
    let cruise = h / v - (2.0 * rise + hold);
    let top = jerk * rise;
    let up = [(rise, 0.0, jerk), (hold, top, 0.0), (rise, top, -jerk)];
    let down = [(rise, 0.0, -jerk), (hold, -top, 0.0), (rise, -top, jerk)];
    let (mut s, mut v) = (0.0, 0.0);
    for (duration, a, j) in up.into_iter().chain([(cruise, 0.0, 0.0)]).chain(down) {
        if duration > SHORTEST {
            let phase = Phase { duration, s, v, a, j };
            Instant { s, v, .. } = phase.at(duration);
            give(phase);
        }
    }
}

/// Share of the time of one ramp over a cell that several phases must save, to be worth it.
const WORTH: f64 = 0.03;

/// Phases of constant s̈ over a cell of a curve: one, or, where the axes could do it in much less
/// (at a low feed, from rest or to it, along a curve so flat that it is one cell), as over a line.
pub(crate) fn over_curve(
    rows: &Rows,
    h: f64,
    cap: f64,
    (b0, b1): (f64, f64),
    mut give: impl FnMut(Phase),
) {
    let all = || rows.all().iter();
    // half of what the axes can do may go into the bend
    let top = all().map(|row| 0.5 / row.a2.abs()).fold(cap, f64::min).max(b0).max(b1);
    let room = |row: &LimitRow| (1.0 - row.a2.abs() * top) / row.a1.abs();
    let accel = all().filter(|row| row.a1 != 0.0).map(room).fold(f64::INFINITY, f64::min);
    let (v0, v1) = (libm::sqrt(b0), libm::sqrt(b1));
    let duration = 2.0 * h / (v0 + v1);
    if accel * 2.0 * h > (b1 - b0).abs() {
        let mut sum = 0.0;
        over_line(h, accel, top, b0, b1, |phase| sum += phase.duration);
        if sum < (1.0 - WORTH) * duration {
            return over_line(h, accel, top, b0, b1, give);
        }
    }
    if duration.is_finite() {
        give(Phase { duration, s: 0.0, v: v0, a: (v1 - v0) / duration, j: 0.0 });
    }
}

//! Motion of one axis whose target may change at any moment: jog, handwheel, homing.
//!
//! ```text
//!   goal: a speed, or a place ─┐
//!   limits: speed, acceleration, jerk ─┼─► State::next ─► position, speed, acceleration one period later
//!   ends of travel ────────────┘
//! ```
//!
//! Within a period the jerk is constant. Every period takes the acceleration, among those that the
//! jerk reaches, that leads to the goal soonest and from which the axis can still come to rest
//! before the end: where it comes to rest when it brakes as hard as it may grows with that
//! acceleration, so the largest one is found by bisection. The end is kept within a quarter of a
//! micrometre: periods are no finer. Units: mm (or degrees) and s.
use libm::sqrt;

/// What one axis keeps, whatever its target does.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OnlineLimits {
    /// Largest speed, mm/s.
    pub speed: f64,
    /// Largest acceleration, mm/s².
    pub accel: f64,
    /// Largest jerk, mm/s³; infinite where only the acceleration is limited.
    pub jerk: f64,
}

/// Where it shall go.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Goal {
    /// At this speed, signed, mm/s; zero is a stop.
    Speed(f64),
    /// To this place, mm.
    Position(f64),
}

/// Where an axis is in its motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OnlineState {
    /// mm.
    pub position: f64,
    /// mm/s.
    pub speed: f64,
    /// mm/s².
    pub accel: f64,
    /// Of the period that has led here, mm/s³.
    pub jerk: f64,
}

/// Shares of acceleration and jerk that braking counts on: what lies between the instants of the
/// periods takes the rest.
const COUNTED: (f64, f64) = (0.98, 0.9);
/// Halvings of the interval of accelerations: what is left of it is below what a number can hold.
const HALVINGS: u32 = 48;
/// At rest at its goal within this, mm.
const AT_GOAL_MM: f64 = 1e-7;

impl OnlineState {
    /// At rest.
    pub const fn at_rest(position: f64) -> Self {
        Self { position, speed: 0.0, accel: 0.0, jerk: 0.0 }
    }

    /// It stands.
    pub fn is_at_standstill(&self) -> bool {
        self.speed == 0.0 && self.accel == 0.0
    }

    /// It stands where the goal wants it.
    pub fn has_reached(&self, goal: Goal) -> bool {
        self.is_at_standstill()
            && match goal {
                Goal::Speed(speed) => speed == 0.0,
                Goal::Position(place) => (self.position - place).abs() <= AT_GOAL_MM,
            }
    }

    /// One period later. `ends` are those of travel, from and to; an axis that is beyond one of
    /// them, or cannot stop before it, is not driven back, but comes to rest where it first can.
    #[must_use]
    pub fn next(&self, goal: Goal, limits: &OnlineLimits, ends: (f64, f64), period_s: f64) -> Self {
        let j = limits.jerk.min(2.0 * limits.accel / period_s);
        let (braking, braking_j) = counted(limits, period_s);
        let rest = stops_at(self, braking, braking_j);
        let (from, to) = (ends.0.min(rest), ends.1.max(rest));
        let goal = match goal {
            Goal::Position(place) => Goal::Position(place.clamp(from, to)),
            Goal::Speed(speed) => Goal::Speed(speed.clamp(-limits.speed, limits.speed)),
        };
        if let Some(arrived) = self.arrives(goal, j, period_s) {
            return arrived;
        }
        let reach = (self.accel - j * period_s, self.accel + j * period_s);
        let reach =
            (reach.0.max(-limits.accel).min(reach.1), reach.1.min(limits.accel).max(reach.0));
        let after = |accel: f64| self.after(accel, period_s);
        let place = |accel: f64| stops_at(&after(accel), braking, braking_j);
        // the speeds that are reached on the way to rest of the acceleration, from below and from
        // above
        let fastest = |accel: f64| fastest(&after(accel), braking_j);
        let slowest = |accel: f64| -fastest_mirrored(&after(accel), braking_j);
        let accel = match goal {
            Goal::Speed(wanted) => {
                let free = if self.speed <= wanted {
                    highest(reach, wanted, fastest)
                } else {
                    highest(reach, wanted, slowest)
                };
                let (least, most) = (highest(reach, from, place), highest(reach, to, place));
                free.max(least.min(most)).min(most)
            }
            Goal::Position(wanted) => {
                let free = highest(reach, wanted, place);
                let least = highest(reach, -limits.speed, slowest);
                let most = highest(reach, limits.speed, fastest);
                free.max(least).min(most)
            }
        };
        // the speed at the period's end is within its limit, whatever else is wanted
        let end = |accel: f64| after(accel).speed;
        let least = highest(reach, -limits.speed, end);
        after(accel.max(least).min(highest(reach, limits.speed, end)))
    }

    /// So near to its goal that the next period ends there at rest.
    fn arrives(&self, goal: Goal, j: f64, period_s: f64) -> Option<Self> {
        let small_speed = j * period_s * period_s;
        let is_slow = self.speed.abs() <= small_speed && self.accel.abs() <= j * period_s;
        match goal {
            Goal::Speed(0.0) if is_slow => {
                Some(Self::at_rest(self.position + self.speed * period_s / 2.0))
            }
            Goal::Position(place)
                if is_slow && self.may_end_at(place - self.position, j, period_s) =>
            {
                Some(Self::at_rest(place))
            }
            Goal::Speed(_) | Goal::Position(_) => None,
        }
    }

    /// A last step of this length and none after it: third differences of the places keep the jerk
    /// too.
    fn may_end_at(&self, step: f64, j: f64, period_s: f64) -> bool {
        let h = period_s;
        let before = h * (self.speed - h * (self.accel / 2.0 - h * self.jerk / 6.0));
        let goes_on = h * (self.speed + h * self.accel / 2.0);
        let most = j * h * h * h;
        step.abs() <= AT_GOAL_MM
            || ((step - goes_on).abs() <= most / 6.0
                && (before - 2.0 * step).abs() <= most
                && step.abs() <= most)
    }

    /// A period later, with this acceleration at its end.
    fn after(&self, accel: f64, period_s: f64) -> Self {
        let (h, jerk) = (period_s, (accel - self.accel) / period_s);
        Self {
            position: self.position + h * (self.speed + h * (self.accel / 2.0 + h * jerk / 6.0)),
            speed: self.speed + h * (self.accel + accel) / 2.0,
            accel,
            jerk,
        }
    }
}

/// What braking counts on. Where only the acceleration is limited, it is reached within a period.
fn counted(limits: &OnlineLimits, period_s: f64) -> (f64, f64) {
    let jerk = limits.jerk.min(limits.accel / period_s);
    (COUNTED.0 * limits.accel, COUNTED.1 * jerk)
}

/// The largest acceleration within reach whose outcome, which grows with it, is not beyond
/// `wanted`; the least if all are.
fn highest((mut low, mut high): (f64, f64), wanted: f64, outcome: impl Fn(f64) -> f64) -> f64 {
    if outcome(high) <= wanted {
        return high;
    }
    if outcome(low) >= wanted {
        return low;
    }
    for _ in 0..HALVINGS {
        let middle = low + (high - low) / 2.0;
        if outcome(middle) <= wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The speed that is left when the acceleration has been taken back.
fn settles_at(state: &OnlineState, j: f64) -> f64 {
    state.speed + state.accel * state.accel.abs() / (2.0 * j)
}

/// The greatest speed until the acceleration has been taken back.
fn fastest(state: &OnlineState, j: f64) -> f64 {
    state.speed + state.accel.max(0.0) * state.accel / (2.0 * j)
}

/// The same of the motion in the other sense.
fn fastest_mirrored(state: &OnlineState, j: f64) -> f64 {
    let (speed, accel) = (-state.speed, -state.accel);
    fastest(&OnlineState { speed, accel, ..*state }, j)
}

/// Where it comes to rest when it brakes as hard as it may: acceleration to −p, held, and back to
/// zero.
fn stops_at(state: &OnlineState, most: f64, j: f64) -> f64 {
    // mirrored so that it has to be slowed down from a positive speed
    let sense = if settles_at(state, j) < 0.0 { -1.0 } else { 1.0 };
    let (speed, accel) = (sense * state.speed, sense * state.accel);
    let square = (j * speed + accel * accel / 2.0).max(0.0);
    let peak = sqrt(square).min(most).max(-accel);
    let lasts = ((speed + accel * accel / (2.0 * j) - peak * peak / j)
        / peak.max(f64::MIN_POSITIVE))
    .max(0.0);
    let mut at = OnlineState { position: 0.0, speed, accel, jerk: 0.0 };
    for (jerk, time) in
        [(-j, (accel + peak) / j), (0.0, if peak > 0.0 { lasts } else { 0.0 }), (j, peak / j)]
    {
        at.position += time * (at.speed + time * (at.accel / 2.0 + time * jerk / 6.0));
        at.speed += time * (at.accel + time * jerk / 2.0);
        at.accel += time * jerk;
    }
    state.position + sense * at.position
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const H: f64 = 250e-6;
    const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

    fn limits() -> impl Strategy<Value = OnlineLimits> {
        (1.0..800.0_f64, 200.0..12_000.0_f64, prop_oneof![Just(f64::INFINITY), 5e3..2e5_f64])
            .prop_map(|(speed, accel, jerk)| OnlineLimits { speed, accel, jerk })
    }

    /// All of a motion's limits, from one period to the next.
    fn keeps(
        limits: &OnlineLimits,
        before: &OnlineState,
        now: &OnlineState,
    ) -> Result<(), std::string::String> {
        let near = |limit: f64| limit * (1.0 + 1e-9) + 1e-9;
        let jerk = (now.accel - before.accel).abs() / H;
        if now.speed.abs() > near(limits.speed) {
            return Err(std::format!("speed {} of {}", now.speed, limits.speed));
        }
        if now.accel.abs() > near(limits.accel) {
            return Err(std::format!("acceleration {} of {}", now.accel, limits.accel));
        }
        // the last period comes to rest from what remains of one period's jerk
        if jerk > near(limits.jerk.min(2.0 * limits.accel / H)) {
            return Err(std::format!("jerk {jerk} of {}", limits.jerk));
        }
        Ok(())
    }

    /// Shortest time of a move from rest to rest over this distance, by the seven stretches of
    /// constant jerk.
    fn shortest(distance: f64, limits: &OnlineLimits) -> f64 {
        let (v, a) = (limits.speed, limits.accel);
        let j = limits.jerk.min(2.0 * a / H);
        // rise from rest to a speed: with or without the greatest acceleration
        let rise = |v: f64| if v * j > a * a { v / a + a / j } else { 2.0 * (v / j).sqrt() };
        if v * rise(v) <= distance {
            return 2.0 * rise(v) + (distance - v * rise(v)) / v;
        }
        let (mut low, mut high) = (0.0, v);
        for _ in 0..100 {
            let middle = f64::midpoint(low, high);
            if middle * rise(middle) < distance { low = middle } else { high = middle }
        }
        2.0 * rise(low)
    }

    proptest! {
        #[test]
        fn a_move_to_a_place_takes_the_shortest_time_and_keeps_every_limit(
            limits in limits(),
            distance in prop_oneof![1e-3..0.1_f64, 0.1..500.0_f64],
        ) {
            let mut state = OnlineState::default();
            let mut periods = 0_u32;
            let longest = shortest(distance, &limits) / H;
            while !state.has_reached(Goal::Position(distance)) {
                let next = state.next(Goal::Position(distance), &limits, FREE, H);
                prop_assert!(keeps(&limits, &state, &next).is_ok(), "{:?} {state:?} {next:?}", keeps(&limits, &state, &next));
                prop_assert!(next.position <= distance + 2.5e-4, "beyond by {}", next.position - distance);
                state = next;
                periods += 1;
                prop_assert!(f64::from(periods) < 1.08 * longest + 60.0, "{periods} periods where {longest} are needed: {state:?}");
            }
        }

        #[test]
        fn whatever_is_asked_for_the_ends_of_travel_and_the_limits_hold(
            limits in limits(),
            goals in prop::collection::vec(
                (prop_oneof![
                    (-900.0..900.0_f64).prop_map(Goal::Speed),
                    (-60.0..60.0_f64).prop_map(Goal::Position),
                ], 1_u32..1500), 1..8),
        ) {
            let ends = (-50.0, 40.0);
            let mut state = OnlineState::default();
            for (goal, periods) in goals {
                for _ in 0..periods {
                    let next = state.next(goal, &limits, ends, H);
                    prop_assert!(keeps(&limits, &state, &next).is_ok(), "{:?} {state:?} {next:?}", keeps(&limits, &state, &next));
                    state = next;
                    prop_assert!(state.position >= ends.0 - 2.5e-4 && state.position <= ends.1 + 2.5e-4, "{state:?}");
                }
            }
            // and it can always be stopped
            let j = limits.jerk.min(limits.accel / H);
            let mut left = 4.0 * (limits.speed / limits.accel + 2.0 * limits.accel / j) / H + 100.0;
            while !state.is_at_standstill() && left > 0.0 {
                state = state.next(Goal::Speed(0.0), &limits, ends, H);
                prop_assert!(state.position >= ends.0 - 2.5e-4 && state.position <= ends.1 + 2.5e-4, "{state:?}");
                left -= 1.0;
            }
            prop_assert!(state.is_at_standstill(), "{state:?}");
        }
    }

    #[test]
    fn an_axis_beyond_its_end_stands_until_it_is_moving_manually_back() {
        let limits = OnlineLimits { speed: 100.0, accel: 1000.0, jerk: 1e4 };
        let ends = (-50.0, 40.0);
        let beyond = OnlineState::at_rest(41.0);
        assert_eq!(beyond.next(Goal::Speed(20.0), &limits, ends, H).position, 41.0);
        let mut state = beyond;
        for _ in 0..8000 {
            state = state.next(Goal::Speed(-20.0), &limits, ends, H);
        }
        assert!(state.position < 5.0 && (state.speed + 20.0).abs() < 1e-6, "{state:?}");
    }
}

//! The cycle as a machinist would check it, on a spindle that does exactly what it is told.
use super::*;
use crate::{StrokePoint, stopping_angle};
use std::{borrow::ToOwned, format, string::String};

/// Constant acceleration, constant speed, constant deceleration.
#[derive(Debug, PartialEq)]
struct Trapezoid {
    turns: f64,
    spin: f64,
    accel: f64,
}

impl Trapezoid {
    fn ramp_s(&self) -> f64 {
        self.spin / self.accel
    }
    fn cruise_s(&self) -> f64 {
        self.turns / self.spin - self.ramp_s()
    }
}

impl Stroke for Trapezoid {
    fn at(&self, time: Time) -> StrokePoint {
        let (t, ramp, brake) = (time.value(), self.ramp_s(), self.ramp_s() + self.cruise_s());
        let (s, v, a) = if t < ramp {
            (self.accel * t * t / 2.0, self.accel * t, self.accel)
        } else if t < brake {
            (self.spin * (t - ramp / 2.0), self.spin, 0.0)
        } else {
            let left = (brake + ramp - t).max(0.0);
            (self.turns - self.accel * left * left / 2.0, self.accel * left, -self.accel)
        };
        StrokePoint {
            turned: Angle::rev(s),
            spin: Spin::rev_per_s(v),
            accel: SpinAccel::rev_per_s2(if t < brake + ramp { a } else { 0.0 }),
        }
    }
    fn duration(&self) -> Time {
        Time::s(2.0 * self.ramp_s() + self.cruise_s())
    }
    fn length(&self) -> Angle {
        Angle::rev(self.turns)
    }
    fn brake(&self) -> Time {
        Time::s(self.ramp_s() + self.cruise_s())
    }
}

const STROKE: Trapezoid = Trapezoid { turns: 32.0, spin: 100.0, accel: 400.0 };

fn m6(encoder_following: bool, start_angle: Option<Angle>) -> Tap<'static, Trapezoid> {
    Tap {
        lead: Lead::mm_per_rev(-1.0),
        start: Length::mm(2.0),
        bottom: Length::mm(-30.0),
        end: Length::mm(2.0),
        spin: Spin::rpm(6000.0),
        inward: &STROKE,
        dwell: Time::ZERO,
        outward: &STROKE,
        start_angle,
        encoder_following,
        early: Angle::ZERO,
        spoken: None,
        approach: (Speed::mm_per_s(50.0), Accel::mm_per_s2(500.0)),
        halt: Halt {
            level: SpinAccel::rev_per_s2(400.0),
            power: 20_000.0,
            jerk: units::SpinJerk::rev_per_s3(50_000.0),
            slow: (Spin::rpm(300.0), SpinAccel::rev_per_s2(100.0)),
            on: (Spin::rpm(3000.0), SpinAccel::rev_per_s2(150.0)),
            clear: Length::mm(2.0),
        },
    }
}

struct Run {
    log: String,
    deepest: f64,
    deepest_order: f64,
    end: f64,
    /// Turns still to go when braking began.
    braked_at: f64,
}

/// The one place that knows the API: run the cycle on an ideal spindle whose speed is `factor`
/// times what is ordered.
fn run(tap: &Tap<Trapezoid>, first_angle: f64, factor: f64) -> Run {
    let h = Time::s(250e-6);
    let (mut cycle, mut angle, mut spin, mut held) = (Cycle::new(), first_angle, 0.0, None);
    let mut seen = Run {
        log: String::new(),
        deepest: tap.start.value(),
        deepest_order: tap.start.value(),
        end: 0.0,
        braked_at: 0.0,
    };
    for k in 0..20_000 {
        let master = Rotation {
            angle: Angle::rev(angle),
            spin: Spin::rev_per_s(spin),
            accel: SpinAccel::ZERO,
        };
        let next = cycle.next(
            tap,
            &Tick {
                elapsed: h,
                master,
                followed: master,
                at_rest: spin.abs() < 1e-6,
                held,
                rest: false,
                out: false,
            },
        );
        let name = |c: &Cycle| format!("{c:?}").split('(').next().unwrap().to_owned();
        if name(&next) != name(&cycle) {
            seen.log += &(name(&next) + " ");
        }
        if let (Cycle::In(_, was), Cycle::In(_, is)) = (&cycle, &next)
            && was.wait_at.is_some()
            && is.wait_at.is_none()
        {
            seen.braked_at = tap.inward.turns - (angle - first_angle);
        }
        cycle = next;
        let ordered = match cycle.ask(tap, Time::ZERO) {
            Ask::Rest => Rotation { angle: master.angle, ..Rotation::default() },
            Ask::Hold(to) => {
                let to = to.map_or(angle, Angle::value);
                held = Some(Angle::rev(to));
                Rotation { angle: Angle::rev(to), ..Rotation::default() }
            }
            Ask::Angle(rotation) | Ask::Speed(rotation) => rotation,
        };
        let obeyed = if tap.encoder_following { master } else { ordered };
        let z = cycle.axis(tap, obeyed).position.value();
        seen.deepest_order = seen.deepest_order.min(z);
        if tap.encoder_following {
            spin = ordered.spin.value() * factor;
            angle += spin * h.value();
            seen.deepest = seen.deepest.min(z);
        } else {
            (angle, spin) = (ordered.angle.value(), ordered.spin.value());
            seen.deepest = seen.deepest.min(z);
        }
        seen.end = z;
        assert!(k < 19_999, "it never ended: {cycle:?}");
        if cycle == Cycle::Done {
            break;
        }
    }
    seen
}

#[test]
fn a_command_synchronised_tap_orients_goes_in_and_comes_out() {
    let seen = run(&m6(false, Some(Angle::rev(0.25))), 0.25, 1.0);
    assert_eq!(seen.log, "Orient In Out Done ");
}

#[test]
fn a_commanded_stroke_meets_the_depth_without_overrun() {
    let seen = run(&m6(false, None), 7.3, 1.0);
    // The bottom falls between two periods: ½·a·(h/2)² = 3 nm at most is not seen.
    assert!((seen.deepest + 30.0).abs() < 1e-5, "{}", seen.deepest);
    assert!(seen.deepest >= -30.0, "{}", seen.deepest);
    assert_eq!(seen.end, 2.0);
}

#[test]
fn a_dwell_is_waited_for_at_the_bottom() {
    let tap = Tap { dwell: Time::s(0.1), ..m6(false, None) };
    assert_eq!(run(&tap, 0.0, 1.0).log, "Orient In Bottom Out Done ");
}

#[test]
fn an_encoder_following_tap_steps_onto_its_coupling_and_off_it() {
    let seen = run(&m6(true, Some(Angle::rev(0.25))), 0.75, 1.0);
    assert_eq!(seen.log, "StepOn In Out RunDown Leave Done ");
    assert_eq!(seen.end, 2.0);
}

#[test]
fn braking_begins_when_the_turns_left_are_the_stopping_angle() {
    let seen = run(&m6(true, None), 0.0, 1.0);
    let stopping = stopping_angle(Spin::rpm(6000.0), SpinAccel::rev_per_s2(400.0)).value();
    let a_period = 100.0 * 250e-6;
    assert!((seen.braked_at - stopping).abs() <= a_period, "{} {stopping}", seen.braked_at);
}

#[test]
fn an_encoder_following_tap_meets_its_depth_with_a_spindle_slower_than_ordered() {
    // Half a percent slow: the clock waits at full speed for the turns that are missing, and the
    // stopping angle is short by half a percent of 12.5 turns.
    let seen = run(&m6(true, None), 0.0, 0.995);
    assert!((seen.deepest + 30.0).abs() < 0.005 * 12.5 + 0.03, "{}", seen.deepest);
}

#[test]
fn what_was_overrun_is_braked_for_earlier_the_next_time() {
    let planned = run(&m6(true, None), 0.0, 1.0);
    let early = run(&Tap { early: Angle::rev(0.5), ..m6(true, None) }, 0.0, 1.0);
    assert!((early.braked_at - planned.braked_at - 0.5).abs() < 100.0 * 250e-6);
    assert!((early.deepest - planned.deepest - 0.5).abs() < 1e-3);
}

#[test]
fn the_order_ahead_of_the_reversal_already_turns_back() {
    let tap = m6(false, None);
    let coupling = Coupling::line(tap.lead, Angle::ZERO, tap.start);
    let near = Clock { at: STROKE.duration() - Time::s(1e-3), wait_at: None };
    let Ask::Angle(ahead) = Cycle::In(coupling, near).ask(&tap, Time::s(3e-3)) else {
        panic!("a commanded tap asks for an angle")
    };
    assert!((ahead.spin.value() + 400.0 * 2e-3).abs() < 1e-9, "{ahead:?}");
    // Slowing down inwards and speeding up outwards are the same acceleration.
    assert_eq!(ahead.accel, SpinAccel::rev_per_s2(-400.0));
}

#[test]
fn a_left_hand_tap_is_the_mirror_image() {
    let right = m6(false, None);
    let left = Tap { lead: -right.lead, spin: -right.spin, ..m6(false, None) };
    let (a, b) = (run(&right, 0.0, 1.0), run(&left, 0.0, 1.0));
    assert_eq!((a.deepest, a.log), (b.deepest, b.log));
}

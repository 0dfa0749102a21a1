//! A tap's stroke against closed forms, lower bounds and the spindle's curve.
mod common;
use common::{SPINDLE, axis};
use plan::{Limiting, StrokeRequest};
use units::{Angle, Lead, Spin, Torque};

#[test]
fn show() {
    let r = StrokeRequest {
        revolutions: Angle::rev(32.0),
        spin: Spin::rpm(6000.0),
        lead: Lead::mm_per_rev(1.0),
        cut: Torque::n_m(1.73),
        force_ramp: None,
    };
    let s = r.plan(&SPINDLE, &axis(-300.0, 0.0, 15.0));
    for p in s.profile.pieces() {
        println!("{:?}", p);
    }
    println!("{} {:?} peak {}", s.profile.duration(), s.limiting, s.profile.peak() * 60.0);
    let r = SPINDLE.ramp(Spin::ZERO, Spin::rpm(6000.0));
    println!("ramp {} {}", r.duration(), r.pieces().len());
    let r = SPINDLE.ramp(Spin::rpm(-10000.0), Spin::rpm(10000.0));
    println!("ramp {} {}", r.duration(), r.pieces().len());
    assert_eq!(s.limiting.speed, Limiting::ProgrammedSpeed);
}

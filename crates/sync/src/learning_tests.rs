//! Learning on plants whose answer is known.
use super::*;
use std::boxed::Box;

const HOW: Learning = Learning { gain: 0.7, bandwidth_hz: 60.0 };

fn record() -> Box<LearningRecord> {
    let key = StrokeKey {
        tool: 3,
        lead: Lead::mm_per_rev(-1.0),
        spin: Spin::rpm(6000.0),
        return_spin: Spin::rpm(-6000.0),
        turns: Angle::rev(30.0),
        times: (Time::s(0.5), Time::s(0.5)),
    };
    Box::new(LearningRecord::new(key, HOW.gain))
}

/// One stroke of an axis that adds a repeating disturbance to what it is given; rms of its error,
/// mm.
fn stroke(record: &mut LearningRecord, answer: f64, disturbance: impl Fn(f64) -> f64) -> f64 {
    let (mut squares, h) = (0.0, 250e-6);
    record.begin();
    for k in 0..4000 {
        let t = f64::from(k) * h;
        let (feed, _) = record.correction(Time::s(t));
        let error = -(answer * feed.u + disturbance(t));
        record.note(Time::s(t), Length::mm(error), Angle::ZERO);
        squares += error * error;
    }
    let rms = f64::sqrt(squares / 4000.0);
    record.finish(Length::mm(rms), &HOW);
    rms
}

/// A bump of 5 µm, 20 ms wide, at the reversal.
fn bump(t: f64) -> f64 {
    0.005 * f64::exp(-((t - 0.5) / 0.02).powi(2))
}

#[test]
fn a_repeating_error_shrinks_by_one_less_the_gain_with_every_hole() {
    let mut record = record();
    let rms: std::vec::Vec<f64> = (0..4).map(|_| stroke(&mut record, 1.0, bump)).collect();
    for pair in rms.windows(2) {
        assert!((pair[1] / pair[0] - 0.3).abs() < 0.02, "{rms:?}");
    }
}

#[test]
fn an_axis_that_answers_the_wrong_way_is_frozen_with_the_correction_it_had() {
    let mut record = record();
    let first = stroke(&mut record, -1.0, bump);
    for _ in 0..12 {
        stroke(&mut record, -1.0, bump);
    }
    assert!(record.progress.is_over());
    let last = stroke(&mut record, -1.0, bump);
    assert_eq!(first, last, "what is left is not learning at all");
}

#[test]
fn what_is_faster_than_the_filter_is_not_learnt() {
    let mut record = record();
    for _ in 0..5 {
        stroke(&mut record, 1.0, |t| 0.001 * f64::sin(2.0 * PI * 300.0 * t));
    }
    let most = record.feed.cells.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
    // what is left is the sudden beginning and end of the tone, which has low frequencies too
    assert!(most < 5e-5, "{most} mm of 1 µm at five times the bandwidth");
}

#[test]
fn the_filter_has_no_phase() {
    let mut cells = [0.0; 501];
    for (i, cell) in cells.iter_mut().enumerate() {
        *cell = f64::exp(-((i as f64 - 250.0) / 20.0).powi(2));
    }
    LowPass::new(40.0, 1e-3).both_ways(&mut cells);
    for i in 0..250 {
        assert!((cells[i] - cells[500 - i]).abs() < 1e-9, "{i}");
    }
}

#[test]
fn speed_and_acceleration_are_the_derivatives_of_the_correction() {
    let mut record = record();
    for (i, cell) in record.feed.cells.iter_mut().enumerate() {
        *cell = f64::sin(i as f64 / 50.0);
    }
    let d = 1e-6;
    let at = |t: f64| record.correction(Time::s(t)).0;
    for t in [0.1, 0.333, 0.5, 0.77] {
        let (before, now, after) = (at(t - d), at(t), at(t + d));
        let rate = (after.u - before.u) / (2.0 * d);
        let accel = (after.rate - before.rate) / (2.0 * d);
        assert!((now.rate - rate).abs() < 1e-5 * now.rate.abs().max(1.0));
        assert!((now.accel - accel).abs() < 1e-4 * now.accel.abs().max(1.0));
    }
}

#[test]
fn a_correction_never_exceeds_a_tenth_of_a_lead() {
    let mut record = record();
    for _ in 0..4 {
        stroke(&mut record, 0.0, |_| 5.0);
    }
    assert!(record.feed.cells.iter().all(|u| u.abs() <= 0.1));
}

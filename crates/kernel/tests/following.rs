//! Encoder-following taps: the lags are those of the closed forms, and prediction removes them.
use crate::common::*;
use bus::State;
use kernel::{Config, MAX_TRANSPORT, Prediction, SyncMode};
use plan::StepKind;
use units::{Angle, Length, Speed, Time};

fn following(prediction: Prediction, transport: u8) -> (sim::Config, Config) {
    let machine = machine(1);
    let mut control = control(&machine);
    control.synchronisation = SyncMode::EncoderFollowing { prediction, transport };
    control.sync_windows.stop = Length::mm(5.0); // what is to be seen here would stop the machine
    (machine, control)
}

/// True lag of Z behind the spindle at full speed inwards, µm: the mean of the last 20 ms before
/// braking, when what the run-up has left in the loops has decayed.
fn lag_um(order: &TapOrder, prediction: Prediction, transport: u8) -> f64 {
    let (machine, control) = following(prediction, transport);
    let seen = run(&machine, &control, &tapping(order));
    assert_eq!(seen.kernel.faults(), []);
    let inwards: Vec<_> = seen.samples.iter().filter(|s| s.report.state == State::TapIn).collect();
    // the coupling runs through the R plane and the angle at which the spindle stood
    let theta0 = inwards[0].spindle(0).value();
    let full = order.rpm / 60.0;
    let speed = |s: &bus::Sample| s.truth.expect("simulated").spins[0].value().abs();
    let at_speed: Vec<_> = inwards.iter().filter(|s| speed(s) > 0.9999 * full).collect();
    let last = &at_speed[at_speed.len() - 80..];
    let lag = |s: &bus::Sample| {
        let turned = (s.spindle(0).value() - theta0) * order.lead_mm;
        turned - (order.from_mm - s.axis(2).value())
    };
    last.iter().map(|s| lag(s)).sum::<f64>() / last.len() as f64 * 1e3
}

const SLOW: TapOrder = TapOrder { rpm: 3000.0, ..M6 };
const COARSE: TapOrder = TapOrder { lead_mm: 1.75, rpm: 2000.0, ..M6 };

#[test]
fn a_position_loop_alone_lags_by_v_over_kp_plus_v_times_ts_within_2_percent() {
    for order in [M6, SLOW, COARSE] {
        for transport in [0, 1, 2, MAX_TRANSPORT] {
            let v = order.rpm / 60.0 * order.lead_mm;
            let exact = (v / 80.0 + v * 250e-6 * f64::from(transport)) * 1e3;
            let lag = lag_um(&order, Prediction::None, transport);
            assert!((lag - exact).abs() < 0.02 * exact, "{lag} µm, {exact} µm by the closed form");
            let stated = Prediction::None.lag(
                Speed::mm_per_s(v),
                80.0,
                Time::s(250e-6 * f64::from(transport)),
            );
            assert!((stated.in_um() - exact).abs() < 1e-9);
        }
    }
}

#[test]
fn with_speed_feed_forward_it_lags_by_v_times_ts_within_2_percent() {
    for order in [M6, SLOW, COARSE] {
        for transport in [1, 2, MAX_TRANSPORT] {
            let v = order.rpm / 60.0 * order.lead_mm;
            let exact = v * 250e-6 * f64::from(transport) * 1e3;
            let lag = lag_um(&order, Prediction::Speed, transport);
            assert!((lag - exact).abs() < 0.02 * exact, "{lag} µm, {exact} µm by the closed form");
        }
    }
}

#[test]
fn with_prediction_the_lag_is_gone_and_the_depth_is_met_without_overrun() {
    for (transport, tolerance_um) in [(1, 4.0), (MAX_TRANSPORT, 6.0)] {
        let (machine, control) = following(Prediction::Observer, transport);
        let seen = run(&machine, &control, &tapping(&M6));
        assert_eq!(seen.kernel.faults(), []);
        let errors = seen.sync_errors_um(&M6);
        assert!(largest(&errors) < tolerance_um, "{} µm", largest(&errors));
        let overrun_um = (M6.to_mm - seen.deepest_mm()) * 1e3;
        assert!(overrun_um.abs() < 4.0, "{overrun_um} µm beyond the bottom");
    }
}

#[test]
fn without_prediction_turning_back_comes_late_by_the_age_of_the_reading() {
    let (machine, control) = following(Prediction::Speed, 2);
    let seen = run(&machine, &control, &tapping(&M6));
    let overrun_um = (M6.to_mm - seen.deepest_mm()) * 1e3;
    let exact = 100.0 * 2.0 * 250e-6 * 1e3;
    assert!((overrun_um - exact).abs() < 0.1 * exact, "{overrun_um} µm, v·Ts is {exact} µm");
}

#[test]
fn a_thread_entered_at_an_angle_is_entered_there_again() {
    let (machine, control) = following(Prediction::Observer, 1);
    let order = TapOrder { start_angle: Some(Angle::deg(30.0)), rpm: 3000.0, ..M6 };
    let mut steps = tapping(&order);
    steps.insert(2, StepKind::Tap(order.plan()));
    let seen = run(&machine, &control, &steps);
    assert_eq!(seen.kernel.faults(), []);
    // wherever Z is in the material, the spindle is where the helix through 30° at the R plane says
    for s in seen.synchronised().filter(|s| s.axis(2).value() < order.surface_mm) {
        let turns = s.spindle(0).value() - 30.0 / 360.0 - (order.from_mm - s.axis(2).value());
        let off_um = (turns - turns.round()) * order.lead_mm * 1e3;
        assert!(off_um.abs() < 6.0, "{off_um} µm at {}", s.feedback.time);
    }
}

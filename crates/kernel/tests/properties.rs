//! What holds for whatever a machine may say.
use crate::common::*;
use bus::{AxisFeedback, Feedback, SpindleFeedback};
use kernel::{Kernel, Prediction, SyncMode};
use plan::Step;
use proptest::prelude::*;
use test_support::size;
use units::{Angle, Coordinate, Time};

fn numbers(command: &bus::Command) -> bool {
    let axes = command
        .axes
        .iter()
        .all(|axis| axis.position.is_finite() && axis.speed.is_finite() && axis.force.is_finite());
    let spindle =
        |s: &bus::SpindleCommand| s.angle.is_finite() && s.spin.is_finite() && s.torque.is_finite();
    axes && command.spindles.iter().all(spindle)
}

fn feedback(tick: usize, z: f64, angle: f64, ready: bool) -> Feedback {
    let mut said =
        Feedback { time: Time::s(tick as f64 * 250e-6), tool: Some(0), ..Feedback::default() };
    for axis in &mut said.axes {
        *axis = AxisFeedback { ready, ..AxisFeedback::default() };
    }
    said.axes[2].position = Coordinate::new(z);
    said.spindles[0] =
        SpindleFeedback { angle: Angle::rev(angle), ready, ..SpindleFeedback::default() };
    said
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(64, 1280)))]
    #[test]
    fn commands_are_numbers_and_within_the_drives_limits_whatever_the_encoders_say(
        said in prop::collection::vec((-1e6..1e6f64, -1e6..1e6f64), 1..200),
        encoder in any::<bool>(),
    ) {
        let mut config = control(&machine(0));
        if encoder {
            config.synchronisation =
                SyncMode::EncoderFollowing { prediction: Prediction::Observer, transport: 2 };
        }
        // nothing is to stop the loops from being tried
        for axis in config.axes.iter_mut().flatten() {
            axis.windows.following_stop = Coordinate::new(1e300);
        }
        for spindle in config.spindles.iter_mut().flatten() {
            spindle.windows.following_stop = Angle::rev(1e300);
        }
        let mut kernel = Kernel::new(config);
        let tap = plan::StepKind::Tap(TapOrder { from_mm: 0.0, surface_mm: -2.0, to_mm: -30.0, ..M6 }.plan());
        kernel.push(&Step { op: 0, line: 1, kind: turn(0.0, 3000.0) }).unwrap();
        kernel.push(&Step { op: 1, line: 2, kind: tap }).unwrap();
        for (tick, (z, angle)) in [(0.0, 0.0); 3].iter().chain(&said).enumerate() {
            let command = kernel.tick(&feedback(tick, *z, *angle, tick > 0));
            prop_assert!(numbers(&command), "{command:?}");
            prop_assert!(command.axes[2].force.abs().value() <= 23_562.0);
            prop_assert!(command.spindles[0].torque.abs().value() <= 42.0);
        }
    }

    #[test]
    fn a_reading_that_is_no_number_is_a_fault_and_the_outputs_go_off(
        bad in prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY]),
        of_spindle in any::<bool>(),
    ) {
        let mut kernel = Kernel::new(control(&machine(0)));
        for tick in 0..5 {
            kernel.tick(&feedback(tick, 0.0, 0.0, tick > 0));
        }
        let (z, angle) = if of_spindle { (0.0, bad) } else { (bad, 0.0) };
        let command = kernel.tick(&feedback(5, z, angle, true));
        prop_assert!(numbers(&command) && command.axes.iter().all(|a| !a.enable));
        prop_assert_eq!(kernel.faults()[0].kind, kernel::FaultKind::FeedbackInvalid);
    }
}

#[test]
fn two_runs_of_the_same_inputs_are_the_same_to_the_bit() {
    let machine = machine(1);
    let program = tapping(&M6);
    let (a, b) =
        (run(&machine, &control(&machine), &program), run(&machine, &control(&machine), &program));
    assert_eq!(a.samples.len(), b.samples.len());
    assert!(a.samples == b.samples && a.events == b.events);
}

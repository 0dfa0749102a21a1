//! The encoder of a spindle that is told a speed is checked by a slow turn before the spindle is
//! used.
use crate::common::*;
use bus::{Command, Feedback, Machine, State};
use kernel::{Config, EncoderCheckControl, Fault, FaultKind, OwnRamps, Prediction, SyncMode};
use proptest::prelude::*;
use sim::{PlainDrive, SimulatedMachine};
use test_support::size;
use units::{Angle, SpinAccel, Time};

const STATED: u32 = 4096;
const RAMP: SpinAccel = SpinAccel::rev_per_s2(67.0);
const ORIENT_RPM_MOST: f64 = 700.0;

/// A machine whose spindle encoder counts so many counts a turn, read by a scale of [`STATED`];
/// with an index mark a turn, or none.
struct Counted {
    machine: SimulatedMachine,
    counts: f64,
    has_index: bool,
    turned: Angle,
    said: Feedback,
}

impl Counted {
    fn said(&mut self, mut feedback: Feedback) -> &Feedback {
        let turned = feedback.spindles[0].angle;
        let scale = self.counts / f64::from(STATED);
        let passed = turned.value().floor() != self.turned.value().floor() && self.has_index;
        let mark = turned.value().max(self.turned.value()).floor();
        self.turned = turned;
        let counted = (turned.value() * self.counts).floor() / f64::from(STATED);
        feedback.spindles[0].angle = Angle::rev(counted);
        feedback.spindles[0].index = passed.then(|| Angle::rev(mark * scale));
        self.said = feedback;
        &self.said
    }
}

impl Machine for Counted {
    fn period(&self) -> Time {
        self.machine.period()
    }

    fn feedback(&self) -> &Feedback {
        self.machine.feedback()
    }

    fn exchange(&mut self, command: &Command) -> &Feedback {
        let feedback = *self.machine.exchange(command);
        self.said(feedback)
    }
}

fn mill(index: bool) -> (SimulatedMachine, Config) {
    let mut model = machine(1);
    model.spindles[0].encoder.counts_per_rev = STATED;
    let mut control = control(&model);
    control.synchronisation =
        SyncMode::EncoderFollowing { prediction: Prediction::Observer, transport: 1 };
    let spindle = control.spindles[0].as_mut().unwrap();
    spindle.encoder_count = Angle::rev(1.0 / f64::from(STATED));
    spindle.encoder_check = Some(EncoderCheckControl { index });
    let delay = Time::s(0.01);
    let repeats = (Time::s(0.7e-3), 0.002);
    spindle.own_ramps =
        Some(OwnRamps { delay, accel: RAMP, decel: RAMP, uncertainty: 0.25, repeats, creep: 0.1 });
    let drive = PlainDrive {
        delay,
        delay_scatter: Time::ZERO,
        accel: RAMP,
        decel: RAMP,
        ramp_scatter: 0.0,
        speed_scatter: 0.0,
        orients: None,
    };
    (SimulatedMachine::new(model).unwrap().with_plain_drive(drive), control)
}

/// A tap with such an encoder: the first fault, and whether the axis has gone in; the fastest that
/// the spindle was told to turn.
fn tap(counts: f64, has_index: bool, states_index: bool) -> (Option<Fault>, bool, f64) {
    let (machine, control) = mill(states_index);
    let mut machine =
        Counted { said: *machine.feedback(), machine, counts, has_index, turned: Angle::ZERO };
    let order = TapOrder { lead_mm: 1.25, rpm: 1000.0, to_mm: -120.0, ..M6 };
    let seen = run_on(&mut machine, &control, &tapping(&order), 60_000);
    let told = seen.samples.iter().map(|sample| sample.command.spindles[0].spin.in_rpm().abs());
    let goes_in = seen.samples.iter().any(|sample| sample.report.state == State::TapIn);
    (seen.kernel.faults().first().copied(), goes_in, told.fold(0.0, f64::max))
}

#[test]
fn an_encoder_that_is_as_configured_lets_the_tap_go_in() {
    for (has_index, states_index) in [(false, false), (true, true), (true, false)] {
        let (fault, goes_in, _) = tap(f64::from(STATED), has_index, states_index);
        assert!(fault.is_none() && goes_in, "{fault:?}");
    }
}

#[test]
fn a_wrong_sign_a_wrong_scale_and_a_missing_index_are_alarms_with_what_would_work() {
    for (counts, states_index, kind, says) in [
        (
            -4096.0,
            false,
            FaultKind::EncoderReversed,
            "-4096 as the scale of the encoder, would fit",
        ),
        (1024.0, false, FaultKind::EncoderScale, "encoder_counts_per_rev = 1024, and 1024 as"),
        (16_384.0, false, FaultKind::EncoderScale, "encoder_counts_per_rev = 16384, and"),
        (0.0, false, FaultKind::EncoderStandsStill, "counted 0 in a turn, and 4096 would fit"),
        (4096.0, true, FaultKind::SpindleIndexMissing, "one a turn would fit"),
    ] {
        let (fault, goes_in, told) = tap(counts, false, states_index);
        let fault = fault.unwrap();
        let text = fault.to_string();
        assert!(fault.kind == kind && text.contains(says), "{text}");
        assert!(!goes_in && told <= ORIENT_RPM_MOST, "{text}: {told} rpm");
    }
}

/// 4064 for 4096 is no more than a drive may slip; from mark to mark it is seen to a count.
#[test]
fn an_index_mark_shows_a_scale_that_is_off_by_less_than_a_drive_slips() {
    let without = tap(4064.0, true, false);
    assert!(without.0.is_none(), "{:?}", without.0);
    let fault = tap(4064.0, true, true).0.unwrap();
    assert!(fault.kind == FaultKind::EncoderScale, "{fault}");
    assert!((fault.value - 4064.0).abs() <= 2.0, "{fault}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: size::of(24, 480), ..ProptestConfig::default() })]

    /// Whatever is wrong: nothing goes into the work, and the number that is given is the one that
    /// the encoder has.
    #[test]
    fn the_number_that_is_given_would_work(lines in 64_u32..5000, reversed in any::<bool>()) {
        let counts = f64::from(4 * lines) * if reversed { -1.0 } else { 1.0 };
        let (fault, goes_in, _) = tap(counts, false, false);
        let is_right = (counts - f64::from(STATED)).abs() < 0.015 * f64::from(STATED);
        let is_wrong = (counts - f64::from(STATED)).abs() > 0.025 * f64::from(STATED);
        match fault {
            None => prop_assert!(!is_wrong && goes_in, "{counts}"),
            Some(fault) => {
                prop_assert!(!is_right && !goes_in, "{counts}: {fault}");
                let off = (fault.value - counts).abs();
                prop_assert!(off <= 0.005 * counts.abs() + 4.0, "{counts}: {fault}");
            }
        }
    }
}

//! The recorder, given taps whose errors are known beforehand.
use super::*;
use bus::Truth;
use canon::{Position, Span};
use units::{Coordinate, Force, Lead, Spin, Torque};

const PERIOD: f64 = 250e-6;
const TURNS: f64 = 12.0;

/// A hand that taps: +1 right, −1 left; 1.25 mm lead, from Z+2 to Z−13, surface at Z0.
struct Tapper {
    recorder: Recorder,
    now: f64,
    hand: f64,
}

impl Tapper {
    fn new(hand: f64) -> Self {
        Self { recorder: Recorder::new(&ToolLibrary::default()), now: 0.0, hand }
    }

    fn announce(&mut self, op: u32) {
        let tap = Tap {
            axis: Axis::Z,
            start: Position::xyz(10.0, 20.0, 2.0),
            bottom: Length::mm(-13.0),
            surface: Length::ZERO,
            zero: Length::ZERO,
            own_zero: None,
            lead: Lead::mm_per_rev(1.25 * self.hand),
            spin: Spin::rpm(1000.0),
            return_spin: Spin::rpm(1000.0),
            return_acceleration: canon::ReturnAcceleration::AsSet,
            dwell: Time::ZERO,
            start_angle: None,
            peck: None,
        };
        self.recorder.op(op, &Op { span: Span::default(), kind: OpKind::Tap(tap) });
    }

    /// One period at a place of the stroke, off the line by so much, in a state.
    fn period(&mut self, op: u32, state: State, turns: f64, off: Length) -> Sample {
        let z = Length::mm(2.0 - 1.25 * turns);
        let mut sample = Sample::default();
        sample.feedback.time = Time::s(self.now);
        sample.feedback.tool = Some(1);
        (sample.report.op, sample.report.line, sample.report.state) = (op, op + 100, state);
        // a right-hand tap turns clockwise (positive) inwards
        let angle = Angle::rev(7.25 + turns * self.hand);
        sample.command.spindles[0].angle = angle;
        sample.command.axes[Axis::Z.index()].position = Coordinate::linear(z);
        let mut truth = Truth { axis_forces: [Force::ZERO; 9], ..Truth::default() };
        truth.axes[Axis::Z.index()] = Coordinate::linear(z + off);
        truth.spindles[0] = angle;
        truth.spins[0] = Spin::rpm(1000.0);
        sample.truth = Some(truth);
        self.now += PERIOD;
        sample
    }

    fn give(&mut self, op: u32, state: State, turns: f64, off: Length) {
        let sample = self.period(op, state, turns, off);
        self.recorder.sample(&sample);
    }

    /// In and out, off the line by so much while deeper than `from` turns on the way in.
    fn tap(&mut self, op: u32, off: Length, from: f64) {
        self.announce(op);
        for k in 0..=1200 {
            let turns = TURNS * f64::from(k) / 1200.0;
            self.give(op, State::TapIn, turns, if turns > from { off } else { Length::ZERO });
        }
        for k in (0..=1200).rev() {
            self.give(op, State::TapOut, TURNS * f64::from(k) / 1200.0, Length::ZERO);
        }
        self.give(op + 1, State::Rapid, 0.0, Length::ZERO);
    }
}

#[test]
fn a_tap_on_its_line_has_no_error_whatever_its_hand() {
    for hand in [1.0, -1.0] {
        let mut tapper = Tapper::new(hand);
        tapper.tap(1, Length::ZERO, 0.0);
        let trace = tapper.recorder.kept_taps()[0];
        assert!(trace.worst < Length::um(1e-6), "{}", trace.worst);
        assert!(trace.completed);
        assert_eq!((trace.clearance(), trace.whole()), (Length::mm(2.0), Length::mm(15.0)));
        let deepest = trace.stroke[0].points().last().copied().expect("it was recorded");
        assert!((deepest.0 - TURNS).abs() < 1e-9 && (deepest.1 - 15.0).abs() < 1e-9, "{deepest:?}");
    }
}

#[test]
fn an_axis_that_stays_five_micrometres_high_in_the_material_is_not_deep_enough() {
    let mut tapper = Tapper::new(1.0);
    tapper.tap(1, Length::um(5.0), 6.0);
    let trace = tapper.recorder.kept_taps()[0];
    assert!((trace.worst.in_um() - 5.0).abs() < 1e-6, "{}", trace.worst);
    let inward = trace.error[0].points();
    assert!(inward.iter().any(|p| (p.1 + 5.0).abs() < 1e-6 && p.0 > 6.0), "its sign and place");
    assert!(
        trace.error[1].points().iter().all(|p| p.1.abs() < 1e-6),
        "the way out was on the line"
    );
}

#[test]
fn an_error_in_the_air_does_not_count() {
    let mut tapper = Tapper::new(1.0);
    tapper.announce(1);
    for k in 0..=1000 {
        let turns = TURNS * f64::from(k) / 1000.0;
        let in_air = turns * 1.25 < 2.0 - 1e-9;
        tapper.give(1, State::TapIn, turns, if in_air { Length::um(80.0) } else { Length::ZERO });
    }
    assert!(tapper.recorder.kept_taps()[0].worst < Length::um(1e-6));
}

#[test]
fn the_worst_taps_and_the_first_are_kept_and_no_others() {
    let mut tapper = Tapper::new(1.0);
    let errors = [3.0, 9.0, 1.0, 7.0, 8.0, 2.0, 4.0];
    for (nth, error) in errors.into_iter().enumerate() {
        tapper.tap(10 * nth as u32, Length::um(error), 6.0);
    }
    let kept: Vec<_> =
        tapper.recorder.kept_taps().iter().map(|t| t.worst.in_um().round()).collect();
    assert_eq!(kept, [9.0, 8.0, 7.0, 3.0]);
    assert_eq!(tapper.recorder.taps, errors.len());
    assert!(tapper.recorder.announced.is_empty());
}

#[test]
fn a_tap_that_faults_is_worse_than_any_that_came_out() {
    let mut tapper = Tapper::new(1.0);
    tapper.tap(1, Length::um(40.0), 6.0);
    tapper.announce(5);
    for k in 0..600 {
        tapper.give(5, State::TapIn, f64::from(k) * 0.01, Length::ZERO);
    }
    tapper.give(5, State::Faulted, 6.0, Length::ZERO);
    let kept = tapper.recorder.kept_taps();
    assert_eq!((kept[0].op, kept[0].completed), (5, false));
    assert_eq!((kept[1].op, kept[1].completed), (1, true));
}

#[test]
fn a_pause_in_the_hole_does_not_end_the_tap() {
    let mut tapper = Tapper::new(1.0);
    tapper.announce(1);
    for (state, turns) in
        [(State::TapIn, 5.0), (State::Paused, 5.0), (State::TapOut, 4.0), (State::Settle, 0.0)]
    {
        tapper.give(1, state, turns, Length::ZERO);
    }
    assert_eq!(tapper.recorder.taps, 1);
    assert!(tapper.recorder.kept_taps()[0].completed);
}

#[test]
fn a_torque_spike_and_the_time_at_the_limit_are_kept() {
    let mut tapper = Tapper::new(1.0);
    tapper.announce(1);
    for k in 0..40_000u32 {
        let mut sample = tapper.period(1, State::TapIn, f64::from(k) * 3e-4, Length::ZERO);
        let spike = if k == 31_337 { -41.5 } else { 3.0 };
        sample.truth.as_mut().expect("it has one").spindle_torques[0] = Torque::n_m(spike);
        sample.feedback.spindles[0].saturated =
            (1000..1400).contains(&k) || (9000..9040).contains(&k);
        tapper.recorder.sample(&sample);
    }
    let trace = tapper.recorder.kept_taps()[0];
    assert_eq!(trace.torque_max(), Torque::n_m(41.5));
    assert!((trace.saturated_for.value() - 440.0 * PERIOD).abs() < 1e-9, "{}", trace.saturated_for);
    assert_eq!(trace.saturated.len(), 2);
}

#[test]
fn the_tip_is_where_the_axis_is_less_the_tools_length() {
    let tool = canon::Tool {
        number: 1,
        pocket: 1,
        length: Length::mm(92.0),
        diameter: Length::mm(6.0),
        kind: canon::ToolKind::Other,
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    };
    let mut recorder = Recorder::new(&ToolLibrary::new([tool]));
    let sample = Tapper::new(1.0).period(0, State::Rapid, 0.0, Length::ZERO);
    recorder.sample(&sample);
    let tips: Vec<_> = recorder.track.points().map(|p| p.at).collect();
    assert_eq!(tips, [[0.0, 0.0, 2.0 - 92.0]]);
}

#[test]
fn without_a_simulator_speed_comes_from_the_encoder_and_torque_from_the_command() {
    let mut recorder = Recorder::new(&ToolLibrary::default());
    let mut tapper = Tapper::new(1.0);
    tapper.announce(1);
    recorder.announced = tapper.recorder.announced.clone();
    for k in 0..100 {
        let mut sample = tapper.period(1, State::TapIn, 0.0, Length::ZERO);
        sample.truth = None;
        // 1200 rpm = 20 rev/s
        sample.feedback.spindles[0].angle = Angle::rev(20.0 * PERIOD * f64::from(k));
        sample.command.spindles[0].torque = Torque::n_m(1.5);
        recorder.sample(&sample);
    }
    let trace = recorder.kept_taps()[0];
    assert!(trace.speed.points().iter().all(|p| (p.1 - 1200.0).abs() < 1e-6));
    assert_eq!(trace.torque_max(), Torque::n_m(1.5));
}

#[test]
fn of_taps_that_are_tied_to_nothing_the_first_is_kept_with_feed_and_tip_in_a_room_that_does_not_grow()
 {
    let mut tapper = Tapper::new(1.0);
    tapper.announce(3);
    tapper.announce(4);
    for op in [3, 4] {
        for k in 0..20_000 {
            // the feed stands 10 mm below the surface, and the holder lets the tap go 3 mm deeper
            let turns = (f64::from(k) / 1000.0).min(9.6);
            let state = if turns < 9.6 { State::Feed } else { State::Dwell };
            let mut sample = tapper.period(op, state, turns, Length::ZERO);
            let truth = sample.truth.as_mut().expect("given");
            truth.tool_deflection = Length::mm(if turns < 9.6 { 0.0 } else { -3.0 });
            tapper.recorder.sample(&sample);
        }
    }
    let (tap, moments) = tapper.recorder.floating.seen().expect("two were tapped");
    assert_eq!(tap.bottom, Length::mm(-13.0));
    assert!((1000..=4096).contains(&moments.len()), "{}", moments.len());
    let last = moments[moments.len() - 1];
    assert!((last.feed + 10.0).abs() < 1e-9 && (last.tip + 13.0).abs() < 1e-9, "{last:?}");
    assert!(last.time < 5.0, "the second one is not kept: {last:?}");
}

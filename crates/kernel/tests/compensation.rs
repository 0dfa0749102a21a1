//! Compensation between kernel and drives: what is commanded is taken back by what is read, nothing
//! jumps, and homing gives positions their names.
//!
//! The drives here are ideal: a period later they stand where they were told to.
use crate::common::*;
use bus::{Feedback, Sample};
use canon::Axis;
use kernel::{
    AxisCompensation, Deviation, DeviationPoint, DeviationTable, DeviationTables, DeviationWave,
    EncoderPlace, HomingMethod, HomingOrder, Kernel, ManualOrder, SpindleCompensation,
};
use motion::{Goal, OnlineLimits};
use proptest::prelude::*;
use std::f64::consts::TAU;
use units::{Angle, Coordinate, CoordinateAccel, CoordinateSpeed};

const LIMITS: OnlineLimits = OnlineLimits { speed: 100.0, accel: 2000.0, jerk: 50_000.0 };
/// Share of speed and acceleration that compensation may take.
const SHARE: f64 = 0.05;
const TURNS_AFTER: f64 = 2e-3;

/// A table with what is left for turning back.
fn axis(table: DeviationTable) -> AxisCompensation {
    let (speed, accel) = shares(&table);
    let left = (SHARE - accel) * LIMITS.accel;
    let accel = Deviation::new(&table).reversal_acceleration(left, LIMITS.speed);
    AxisCompensation {
        table,
        reversal: (
            CoordinateSpeed::new((SHARE - speed) * LIMITS.speed),
            CoordinateAccel::new(accel),
        ),
        turns_after: Coordinate::new(TURNS_AFTER),
    }
}

fn shares(table: &DeviationTable) -> (f64, f64) {
    let curve = Deviation::new(table);
    let (points, waves) = (curve.bounds_of_points(), curve.bounds_of_waves());
    let (slope, bend) = (points.0 + waves.0, points.1 + waves.1);
    (slope, slope + bend * LIMITS.speed * LIMITS.speed / LIMITS.accel)
}

fn screw() -> DeviationTable {
    let point = |at: f64, up: f64, down: f64| DeviationPoint { at, up, down };
    DeviationTable {
        points: vec![point(-50.0, -4e-3, -2e-3), point(0.0, 0.0, 3e-3), point(50.0, 12e-3, 12e-3)],
        repeats: None,
        waves: vec![DeviationWave { order: 1, amplitude: 2e-3, phase_rev: 0.1 }],
        turn: 16.0,
        backlash: 0.02,
    }
}

struct Bench {
    kernel: Kernel,
    said: Feedback,
    sample: Sample,
    /// What was commanded: to the drive, and of the slide.
    wire: Vec<f64>,
    slide: Vec<f64>,
}

impl Bench {
    fn new(compensation: DeviationTables, at: f64) -> Self {
        let mut config = control(&machine(1));
        config.compensation = compensation;
        // what drives report is where they are: no screw is modelled between
        for axis in config.axes.iter_mut().flatten() {
            axis.encoder.place = EncoderPlace::Scale;
        }
        let mut said = Feedback::default();
        said.axes[0].position = Coordinate::new(at);
        let kernel = Kernel::new(config);
        let (wire, slide) = (Vec::new(), Vec::new());
        Self { kernel, said, sample: Sample::default(), wire, slide }
    }

    fn of(table: DeviationTable, at: f64) -> Self {
        let mut compensation = DeviationTables::default();
        compensation.axes[0] = Some(axis(table));
        let mut bench = Self::new(compensation, at);
        bench.run(20);
        assert!(bench.kernel.is_ready());
        bench
    }

    fn run(&mut self, periods: usize) {
        for _ in 0..periods {
            let command = self.kernel.tick(&self.said);
            self.sample = Sample { feedback: self.said, command, ..Sample::default() };
            self.kernel.in_positions(&mut self.sample);
            self.wire.push(command.axes[0].position.value());
            self.slide.push(self.sample.command.axes[0].position.value());
            self.said.time += PERIOD;
            for (said, told) in self.said.axes.iter_mut().zip(&command.axes) {
                said.ready = told.enable;
                if told.enable {
                    said.position = told.position;
                }
            }
            for (said, told) in self.said.spindles.iter_mut().zip(&command.spindles) {
                said.ready = told.enable;
            }
        }
    }

    fn move_to(&mut self, place: f64) {
        let ends = (f64::NEG_INFINITY, f64::INFINITY);
        let order = ManualOrder { goal: Goal::Position(place), limits: LIMITS, ends, lease: None };
        self.kernel.move_manually(Axis::X, order).expect("it can be moved");
        while self.kernel.is_moving_manually() {
            self.run(1);
        }
        // until the flank has changed
        for _ in 0..400 {
            self.run(50);
            let since = &self.wire[self.wire.len() - 50..];
            if since.iter().all(|wire| wire == &since[0]) {
                break;
            }
        }
    }

    fn x(&self) -> f64 {
        self.kernel.setpoint(Axis::X).expect("it has X").value()
    }

    /// Largest speed and acceleration of what lies between the drive's setpoint and the slide's,
    /// from a period on.
    fn most(&self, from: usize) -> (f64, f64) {
        let h = PERIOD.value();
        let off: Vec<f64> = self.wire.iter().zip(&self.slide).map(|(w, s)| w - s).collect();
        let rates: Vec<f64> = off[from..].windows(2).map(|pair| (pair[1] - pair[0]) / h).collect();
        let speed = rates.iter().fold(0.0_f64, |most, rate| most.max(rate.abs()));
        let bends = rates.windows(2).map(|pair| ((pair[1] - pair[0]) / h).abs());
        (speed, bends.fold(0.0, f64::max))
    }
}

#[test]
fn the_drive_is_told_where_its_encoder_puts_the_slide_and_says_it_back() {
    let curve = Deviation::new(&screw());
    let mut bench = Bench::of(screw(), 0.0);
    for (place, flank) in [(30.0, 1.0), (-20.0, 0.0), (-19.0, 1.0), (7.7, 1.0), (7.0, 0.0)] {
        bench.move_to(place);
        let wire = *bench.wire.last().unwrap();
        assert!((bench.x() - place).abs() < 1e-6);
        assert!((wire + curve.at(wire, flank).value - bench.x()).abs() < 1e-9, "{place}");
        // the observers see the slide, in what is commanded and in what is read
        let (told, read) = (bench.sample.command.axes[0], bench.sample.feedback.axes[0]);
        assert!((told.position.value() - bench.x()).abs() < 1e-9);
        assert!((read.position.value() - bench.x()).abs() < 1e-9);
        assert_eq!(bench.kernel.faults(), []);
        let shift = bench.kernel.shift(Axis::X).value();
        assert!((bench.said.axes[0].position.value() + shift - bench.x()).abs() < 1e-9);
    }
}

#[test]
fn a_slide_that_hardly_goes_back_stays_on_its_flank() {
    let mut bench = Bench::of(DeviationTable { backlash: 0.02, ..DeviationTable::default() }, 0.0);
    let off = |bench: &Bench| bench.wire.last().unwrap() - bench.x();
    assert_eq!(off(&bench), 0.0, "which flank is not known before it has moved");
    bench.move_to(0.25 * TURNS_AFTER);
    assert_eq!(off(&bench), 0.0);
    bench.move_to(5.0);
    assert!((off(&bench) - 0.01).abs() < 1e-9, "the drive leads by half of the play");
    bench.move_to(5.0 - 0.25 * TURNS_AFTER);
    assert!((off(&bench) - 0.01).abs() < 1e-9);
    bench.move_to(5.0 - 3.0 * TURNS_AFTER);
    assert!((off(&bench) + 0.01).abs() < 1e-9, "and lags by it on the way back");
}

#[test]
fn an_axis_is_compensated_once_it_is_homed_and_nothing_moves() {
    let mut bench = Bench::of(screw(), 3.0);
    bench.kernel.forget_home(Axis::X);
    bench.run(4);
    let before = *bench.wire.last().unwrap();
    let order = HomingOrder {
        method: HomingMethod::Given,
        positive: true,
        off_switch: false,
        fast: 50.0,
        slow: 20.0,
        accel: 2000.0,
        jerk: 200_000.0,
        reference: 25.0,
        search: 74.0,
        index_spacing: 16.0,
        pull_off: 1.0,
        force_share: 0.1,
    };
    let from = bench.wire.len();
    bench.kernel.home(Axis::X, &order).expect("it can be homed");
    bench.run(40);
    assert!(bench.kernel.is_homed(Axis::X));
    for wire in &bench.wire[from..] {
        assert!((wire - before).abs() < 1e-9, "{wire} {before}");
    }
    // by its encoder it is at 25, in the middle of its play
    let expected = 25.0 + Deviation::new(&screw()).at(25.0, 0.5).value;
    assert!((bench.x() - expected).abs() < 1e-9, "{} {expected}", bench.x());
    let zero = bench.kernel.zero(Axis::X).value();
    assert!((zero + before - 25.0).abs() < 1e-9, "the reference is the encoder's");
    bench.move_to(10.0);
    bench.kernel.forget_home(Axis::X);
    let wire = *bench.wire.last().unwrap();
    bench.run(4);
    assert!((bench.wire.last().unwrap() - wire).abs() < 1e-9);
    assert!((bench.x() - wire - zero).abs() < 1e-9, "it goes by its encoder again");
    assert_eq!(bench.kernel.faults(), []);
}

/// Tables within the share that a file may have.
fn tables() -> impl Strategy<Value = DeviationTable> {
    let point = (8.0..40.0_f64, -0.03..0.03_f64, -0.01..0.01_f64);
    let points = prop::collection::vec(point, 2..12);
    let waves = prop::collection::vec((1_u32..3, 0.0..3e-3_f64, 0.0..1.0_f64), 0..2);
    (points, waves, 0.0..0.05_f64).prop_map(|(points, waves, backlash)| {
        let mut at = -80.0;
        let points: Vec<_> = points
            .into_iter()
            .map(|(further, up, apart)| {
                at += further;
                DeviationPoint { at, up, down: up + apart }
            })
            .collect();
        let wave = |(order, amplitude, phase_rev)| DeviationWave { order, amplitude, phase_rev };
        let waves: Vec<_> = waves.into_iter().map(wave).collect();
        let mut table = DeviationTable { points, waves, turn: 16.0, backlash, repeats: None };
        let most = shares(&table).0.max(shares(&table).1);
        if most > 0.04 {
            let share = 0.04 / most;
            for point in &mut table.points {
                (point.up, point.down) = (point.up * share, point.down * share);
            }
            table.waves.iter_mut().for_each(|wave| wave.amplitude *= share);
        }
        table
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(test_support::size::of(24, 400)))]
    #[test]
    fn corrections_take_five_percent_of_speed_and_acceleration_and_are_taken_back(
        table in tables(), places in prop::collection::vec(-60.0..60.0_f64, 1..4)
    ) {
        let curve = Deviation::new(&table);
        let mut bench = Bench::of(table, 0.0);
        let from = bench.wire.len();
        for place in places {
            let flank = if place > bench.x() { 1.0 } else { 0.0 };
            if (place - bench.x()).abs() < 1.0 {
                continue;
            }
            bench.move_to(place);
            let wire = *bench.wire.last().unwrap();
            prop_assert!((wire + curve.at(wire, flank).value - bench.x()).abs() < 1e-9);
        }
        let (speed, accel) = bench.most(from);
        prop_assert!(speed <= 1.01 * SHARE * LIMITS.speed, "{speed} mm/s");
        // 1 % and what differences of numbers of 60 mm cannot resolve
        prop_assert!(accel <= 1.01 * SHARE * LIMITS.accel + 0.5, "{accel} mm/s²");
        prop_assert_eq!(bench.kernel.faults(), &[]);
    }
}

#[test]
fn the_angle_of_an_eccentric_encoder_is_even_from_its_index_on() {
    const SIZE: f64 = 3e-5;
    const PHASE: f64 = 0.2;
    let wave = DeviationWave { order: 1, amplitude: SIZE, phase_rev: PHASE };
    let table = DeviationTable { waves: vec![wave], turn: 1.0, ..DeviationTable::default() };
    let mut compensation = DeviationTables::default();
    compensation.spindles[0] = Some(SpindleCompensation { table, from_index: true });
    let mut bench = Bench::new(compensation, 0.0);
    // the encoder's mark lies at 0.37 of its own turns
    let (mark, spin) = (0.37, 10.0);
    let correction = |read: f64| SIZE * ((TAU * (read - mark + PHASE)).sin() - (TAU * PHASE).sin());
    let mut last: Option<f64> = None;
    for period in 0..4000 {
        let (angle, before) =
            (0.1 + spin * PERIOD.value() * f64::from(period), bench.said.spindles[0].angle.value());
        let mut read = angle;
        for _ in 0..8 {
            read = angle - correction(read);
        }
        bench.said.spindles[0].angle = Angle::rev(read);
        let marks = ((read - mark).floor(), (before - mark).floor());
        bench.said.spindles[0].index =
            (marks.0 > marks.1 && period > 0).then(|| Angle::rev(mark + marks.0));
        bench.run(1);
        let seen = bench.sample.feedback.spindles[0].angle.value();
        if period < 300 && angle < mark {
            assert_eq!(seen, read, "nothing is known of the phase before the mark");
        }
        if angle > mark + spin * 0.3 {
            assert!((seen - angle).abs() < 1e-9, "{period}: {seen} {angle}");
            let step = seen - last.unwrap_or(seen - spin * PERIOD.value());
            assert!((step / PERIOD.value() - spin).abs() < 1e-5, "{period}: {step}");
            last = Some(seen);
        }
    }
    assert!(last.is_some());
}

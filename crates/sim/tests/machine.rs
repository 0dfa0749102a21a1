//! The machine on the bus, from outside.
use crate::fixtures::{spindle, tapping_center};
use bus::{Command, Machine};
use proptest::{prop_assert, prop_assert_eq, proptest};
use sim::{Config, SimulatedMachine};
use units::{Coordinate, Force, Length, Per, Spin, Spread, Time, Torque};

fn machine(config: Config) -> SimulatedMachine {
    SimulatedMachine::new(config).expect("the fixture is a machine")
}

/// The cutting force of each hole is off by up to this share.
fn of_holes(share: f64) -> Spread {
    Spread { per: Per::Hole, ..Spread::uniform(share) }
}

/// All drives on, with these references.
fn command(force: f64, torque: f64) -> Command {
    let mut command = Command::default();
    for axis in &mut command.axes {
        axis.enable = true;
        axis.force = Force::n(force);
    }
    for spindle in &mut command.spindles {
        spindle.enable = true;
        spindle.torque = Torque::n_m(torque);
    }
    command
}

#[test]
fn time_advances_by_whole_periods() {
    let mut machine = machine(tapping_center());
    assert_eq!(machine.feedback().time, Time::ZERO);
    for _ in 0..4000 {
        machine.exchange(&command(0.0, 0.0));
    }
    assert_eq!(machine.feedback().time, Time::s(1.0));
}

#[test]
fn two_runs_of_the_same_inputs_are_equal_to_the_last_bit() {
    let run = || {
        let mut config = Config { scatter: of_holes(0.03), seed: 42, ..tapping_center() };
        config.spindles[0].encoder.noise_counts = 2.0;
        config.tool = 2;
        config.axes[2].1.start = Coordinate::new(-199.9); // a tenth of a millimetre over the work
        let mut machine = machine(config);
        let mut rows = Vec::new();
        for i in 0..2000 {
            let swing = (f64::from(i) * 0.01).sin();
            let mut order = Command { tool: 2, ..command(5000.0 * swing, 30.0 * swing) };
            order.axes[2].force = Force::n(-300.0);
            let feedback = *machine.exchange(&order);
            rows.push(format!("{feedback:?} {:?}", machine.truth()));
        }
        assert_eq!(machine.holes().len(), 1);
        rows.push(format!("{:?}", machine.holes()));
        rows
    };
    assert!(run() == run());
}

#[test]
fn another_seed_is_another_machine() {
    let coasts_to = |seed| {
        let mut config = Config { seed, ..tapping_center() };
        for (_, axis) in &mut config.axes {
            axis.scatter.friction = Spread::uniform(0.03);
        }
        let mut machine = machine(config);
        for _ in 0..1000 {
            machine.exchange(&command(3000.0, 10.0));
        }
        machine.truth().map(|truth| truth.axes[2])
    };
    assert_ne!(coasts_to(1), coasts_to(2));
}

#[test]
fn a_delayed_command_is_obeyed_that_many_periods_later() {
    let moves_after = |command_delay| {
        let mut machine = machine(Config { command_delay, ..tapping_center() });
        let still = machine.feedback().spindles[0].angle;
        (0..10).position(|_| machine.exchange(&command(0.0, 40.0)).spindles[0].angle != still)
    };
    assert_eq!(moves_after(0), Some(0));
    assert_eq!(moves_after(3), Some(3));
}

#[test]
fn a_motor_encoder_and_a_scale_differ_by_play_and_stretch() {
    let mut with_scale = tapping_center();
    with_scale.axes[2].1.encoder = sim::AxisEncoder::Scale {
        resolution: Coordinate::linear(Length::um(0.05)),
        motor_counts_per_rev: Some(1 << 20),
    };
    let (mut motor, mut scale) = (machine(tapping_center()), machine(with_scale));
    for _ in 0..40 {
        motor.exchange(&command(10_000.0, 0.0));
        scale.exchange(&command(10_000.0, 0.0));
    }
    let table = scale.truth().unwrap().axes[2];
    let by_scale = table - scale.feedback().axes[2].position;
    assert!(
        by_scale >= Coordinate::ZERO && by_scale < Coordinate::linear(Length::um(0.05)),
        "{by_scale:?}"
    );
    // under way the screw pulls the table: 8.1 m/s² · 150 kg and 1 kN of friction stretch it
    let ahead = motor.feedback().axes[2].position - table;
    assert!(
        ahead > Coordinate::linear(Length::um(5.0)) && ahead < Coordinate::linear(Length::um(60.0)),
        "{ahead:?}"
    );
    let feedback = (motor.feedback().axes[2], scale.feedback().axes[2]);
    assert_eq!(
        feedback.1.motor,
        Some(feedback.0.position),
        "the motor has an encoder beside the scale"
    );
}

#[test]
fn the_index_is_latched_once_a_turn_at_whole_revolutions() {
    let mut machine = machine(tapping_center());
    let (mut marks, mut last) = (Vec::new(), machine.feedback().spindles[0].angle);
    for _ in 0..1500 {
        let feedback = machine.exchange(&command(0.0, 20.0)).spindles[0];
        if let Some(mark) = feedback.index {
            assert!(mark > last && mark <= feedback.angle, "{last} {mark} {}", feedback.angle);
            marks.push(mark.value());
        }
        last = feedback.angle;
    }
    let turns: Vec<f64> = (1..=marks.len()).map(|n| n as f64).collect();
    assert!(marks.len() > 10);
    assert_eq!(marks, turns);
}

#[test]
fn a_change_of_tool_leaves_the_spindle_empty_for_its_time() {
    let mut machine = machine(tapping_center());
    assert_eq!(machine.feedback().tool, Some(0));
    let order = Command { tool: 2, ..command(0.0, 0.0) };
    let empty = (0..10_000).take_while(|_| machine.exchange(&order).tool.is_none()).count();
    assert_eq!(empty + 1, 6000); // 1.5 s at 4 kHz
    assert_eq!(machine.feedback().tool, Some(2));
}

#[test]
fn a_config_that_no_machine_can_have_is_refused_with_all_its_faults_at_once() {
    let mut config = tapping_center();
    config.substep = Time::s(250e-6);
    config.axes[0].1.table = units::Mass::kg(-1.0);
    config.axes[1].0 = 12;
    config.spindles.push(spindle());
    config.spindles.push(spindle());
    config.magazine[1].number = 1;
    config.scatter = of_holes(f64::NAN);
    let problems = SimulatedMachine::new(config).expect_err("nothing of it can be built");
    insta::assert_snapshot!(problems.join("\n"));
}

#[test]
fn a_step_too_coarse_for_an_axis_is_refused_with_the_step_that_would_do() {
    let mut config = tapping_center();
    config.period = Time::s(2e-3);
    config.substep = Time::s(1e-3);
    let problems = SimulatedMachine::new(config.clone()).expect_err("it would explode");
    assert!(problems.iter().all(|p| p.contains("or less would do")), "{problems:?}");
    config.substep = Time::s(500e-6);
    assert!(SimulatedMachine::new(config.clone()).is_ok());
    config.spindles[0].rounding = Spin::rev_per_s(1e-4);
    let problems = SimulatedMachine::new(config).expect_err("its friction would ring");
    assert!(problems.len() == 1 && problems[0].starts_with("spindle 0"), "{problems:?}");
}

#[test]
fn no_number_of_a_config_may_be_missing() {
    let nan = f64::NAN;
    let poison: [fn(&mut Config, f64); 14] = [
        |c, x| c.period = Time::s(x),
        |c, x| c.substep = Time::s(x),
        |c, x| c.tool_change_time = Time::s(x),
        |c, x| c.scatter = of_holes(x),
        |c, x| c.axes[0].1.table = units::Mass::kg(x),
        |c, x| c.axes[0].1.stiffness = units::Stiffness::n_per_mm(x),
        |c, x| c.axes[0].1.weight_share = x,
        |c, x| c.axes[0].1.friction.breakaway = Force::n(x),
        |c, x| c.spindles[0].inertia = units::Inertia::kg_m2(x),
        |c, x| c.spindles[0].encoder.eccentricity = units::Angle::rev(x),
        |c, x| c.magazine[0].length = Length::mm(x),
        |c, x| c.stock.as_mut().unwrap().top = Length::mm(x),
        |c, x| c.stock.as_mut().unwrap().thickness = Some(Length::mm(x)),
        |c, x| c.stock.as_mut().unwrap().cutting_n_per_mm2 = x,
    ];
    for (at, put) in poison.iter().enumerate() {
        let mut config = tapping_center();
        put(&mut config, nan);
        assert!(SimulatedMachine::new(config).is_err(), "number {at}");
    }
}

proptest! {
    #[test]
    fn a_tool_in_the_work_bears_any_command_or_breaks(
        steps in proptest::collection::vec((-3e4..3e4_f64, -60.0..60.0_f64), 1..400),
        tool in 1..3_u32,
    ) {
        let mut config = Config { tool, ..tapping_center() };
        config.axes[2].1.brake = false;
        config.axes[2].1.start = Coordinate::new(if tool == 1 { -179.999 } else { -199.999 });
        let mut machine = machine(config);
        for (force, torque) in steps {
            let mut order = Command { tool, ..command(0.0, torque) };
            order.axes[2].force = Force::n(force - 8000.0); // downwards, more often than not
            machine.exchange(&order);
            let truth = machine.truth().unwrap();
            prop_assert!(truth.tool_deflection.is_finite() && truth.axes[2].is_finite());
            prop_assert!(truth.cutting_force.is_finite() && truth.cutting_torque.is_finite());
            prop_assert!(truth.cutting_torque.abs() < Torque::n_m(20.0));
            prop_assert!(!truth.tool_broken || truth.cutting_force == Force::ZERO);
        }
    }

    #[test]
    fn states_stay_finite_and_bounded_for_any_command(
        steps in proptest::collection::vec((-1e7..1e7_f64, -1e5..1e5_f64, proptest::bool::ANY), 1..200),
    ) {
        let mut machine = machine(tapping_center());
        let fastest = Spin::rpm(1e5);
        for (force, torque, enable) in steps {
            let mut order = command(force, torque);
            order.axes[2].enable = enable;
            order.spindles[0].enable = enable;
            machine.exchange(&order);
            let truth = machine.truth().unwrap();
            for axis in truth.axes {
                prop_assert!(axis.is_finite() && axis.abs() < Coordinate::new(1e6));
            }
            prop_assert!(truth.spindles[0].is_finite() && truth.spins[0].abs() < fastest);
        }
    }

    #[test]
    fn what_is_no_number_in_a_command_is_no_reference(which in 0..3_usize) {
        let poison = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][which];
        let mut machine = machine(tapping_center());
        for _ in 0..10 {
            machine.exchange(&command(poison, poison));
        }
        prop_assert_eq!(machine.truth().unwrap().axes[0], Coordinate::ZERO);
    }
}

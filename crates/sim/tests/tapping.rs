//! A whole machine drills and taps, held by the least servo that can: position and speed in
//! proportion, with feed-forward. What is asserted is the machine's, not the servo's.
use crate::fixtures::tapping_center;
use bus::{Command, Machine, Truth};
use core::f64::consts::TAU;
use sim::oracle::thread::helix;
use sim::{Config, SimulatedMachine};
use units::{Coordinate, Force, Lead, Length, Time, Torque};

const PERIOD: f64 = 250e-6;
const KP: f64 = 80.0;

/// Where spindle and Z shall be: rev and mm, with their rates.
#[derive(Clone, Copy, Default)]
struct Wanted {
    turns: f64,
    spin: f64,
    spin_rate: f64,
    z: f64,
    z_speed: f64,
    z_rate: f64,
}

struct Servo {
    machine: SimulatedMachine,
    tool: u32,
    wanted: Wanted,
    last: (f64, f64),
    saw: Vec<Truth>,
    saturated: bool,
}

impl Servo {
    fn new(config: Config) -> Self {
        let machine = SimulatedMachine::new(config).expect("the fixture is a machine");
        let feedback = *machine.feedback();
        let z = feedback.axes[2].position.value();
        let wanted = Wanted { z, turns: feedback.spindles[0].angle.value(), ..Wanted::default() };
        Self {
            machine,
            tool: 0,
            wanted,
            last: (wanted.turns, z),
            saw: Vec::new(),
            saturated: false,
        }
    }

    /// One period: the references that pull the machine to where it is wanted.
    fn period(&mut self, wanted: Wanted) {
        self.wanted = wanted;
        let feedback = *self.machine.feedback();
        let (turns, z) = (feedback.spindles[0].angle.value(), feedback.axes[2].position.value());
        let (spin, speed) = ((turns - self.last.0) / PERIOD, (z - self.last.1) / PERIOD);
        self.last = (turns, z);
        let mut command = Command { tool: self.tool, ..Command::default() };
        for axis in &mut command.axes {
            axis.enable = true;
        }
        let mass = 1229.5;
        let pull = KP * (wanted.z - z) + wanted.z_speed - speed;
        let force = mass * (wanted.z_rate + TAU * 70.0 * pull) * 1e-3;
        command.axes[2].force = Force::n(force + 150.0 * wanted.z_speed.clamp(-1.0, 1.0));
        let twist = KP * (wanted.turns - turns) + wanted.spin - spin;
        let torque = 0.010 * TAU * (wanted.spin_rate + TAU * 120.0 * twist);
        command.spindles[0].enable = true;
        command.spindles[0].torque = Torque::n_m(torque + 0.3 * wanted.spin.clamp(-1.0, 1.0));
        let answer = self.machine.exchange(&command);
        self.saturated |= answer.spindles[0].saturated;
        self.saw.push(*self.machine.truth().expect("a simulated machine knows"));
    }

    /// Stay for a while.
    fn rest(&mut self, seconds: f64) {
        let Wanted { turns, z, .. } = self.wanted;
        for _ in 0..(seconds / PERIOD) as usize {
            self.period(Wanted { turns, z, ..Wanted::default() });
        }
    }

    /// Turn by so many revolutions, rest to rest, at a speed and an acceleration; Z goes along by
    /// `lead`.
    fn stroke(&mut self, turns: f64, spin: f64, rate: f64, lead: f64) {
        let from = self.wanted;
        let (distance, sense) = (turns.abs(), turns.signum());
        let top = spin.min((distance * rate).sqrt());
        let ramp = top / rate;
        let cruise = distance / top - ramp;
        let total = 2.0 * ramp + cruise;
        for i in 1..=(total / PERIOD).ceil() as usize {
            let t = (i as f64 * PERIOD).min(total);
            let (s, v, a) = if t < ramp {
                (rate * t * t / 2.0, rate * t, rate)
            } else if t < ramp + cruise {
                (top * (t - ramp / 2.0), top, 0.0)
            } else {
                let left = total - t;
                (distance - rate * left * left / 2.0, rate * left, -rate)
            };
            let (s, v, a) = (s * sense, v * sense, a * sense);
            self.period(Wanted {
                turns: from.turns + s,
                spin: v,
                spin_rate: a,
                z: from.z + lead * s,
                z_speed: lead * v,
                z_rate: lead * a,
            });
        }
    }

    fn change_to(&mut self, tool: u32) {
        self.tool = tool;
        self.rest(1.6);
        assert_eq!(self.machine.feedback().tool, Some(tool));
    }
}

/// The fixture with Z already 2 mm over the surface for a tool of this length.
fn over_the_work(tool_length_mm: f64) -> Config {
    let mut config = tapping_center();
    config.axes[2].1.start = Coordinate::new(-300.0 + tool_length_mm + 2.0);
    config
}

/// Peak-to-peak deviation of the tap's edges from a straight helix while they are in the material,
/// mm.
fn widening(saw: &[Truth], lead: f64) -> f64 {
    let deviations = saw
        .iter()
        .map(|t| (t.axes[2].of_linear() + t.tool_deflection, t))
        .filter(|(z, _)| z.value() - 100.0 < -300.5)
        .map(|(z, t)| (z - helix(Length::ZERO, Lead::mm_per_rev(lead), t.spindles[0])).value());
    let (low, high) = deviations
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)));
    high - low
}

#[test]
fn a_hole_is_drilled_and_tapped_in_it() {
    let mut servo = Servo::new(over_the_work(120.0));
    servo.change_to(1);
    servo.stroke(200.0, 60.0, 200.0, -0.1); // 18 mm deep
    let drilling = servo.saw.iter().map(|t| t.cutting_force.value()).fold(0.0, f64::max);
    assert!((drilling - 417.9).abs() < 15.0, "{drilling} N"); // ½·3900·0.1·2.5·sin 59°
    servo.stroke(-200.0, 60.0, 200.0, -0.1);
    servo.stroke(20.0, 60.0, 200.0, -1.0); // the tap is shorter
    servo.change_to(2);
    servo.saw.clear();
    servo.stroke(14.0, 50.0, 250.0, -1.0); // 12 mm deep
    servo.rest(0.05);
    servo.stroke(-14.0, 50.0, 250.0, -1.0);
    servo.rest(0.05);

    let holes = servo.machine.holes();
    assert_eq!(holes.len(), 1);
    let thread = holes[0].thread.expect("it was tapped");
    assert!(!holes[0].assumed && !servo.machine.truth().unwrap().tool_broken);
    assert!((thread.tip_depth.value() - 12.0).abs() < 0.02, "{thread:?}");
    assert!((holes[0].bores[0].tip_depth.value() - 18.0).abs() < 0.02, "{holes:?}");
    // 1.73 N·m and a friction tail of 10 % at two diameters' depth, against the spindle's sense
    let torque = servo.saw.iter().map(|t| t.cutting_torque.value()).fold(0.0, f64::min);
    assert!((torque + 1.73 * 1.1).abs() < 0.08, "{torque} N·m");
    assert!(!servo.saturated);
    let widening = widening(&servo.saw, -1.0);
    assert!(widening > 0.0 && widening < 0.030, "{widening} mm");
}

#[test]
fn a_ramp_beyond_the_power_curve_saturates_the_drive_and_spoils_the_thread() {
    let tapped = |rate| {
        let mut servo = Servo::new(over_the_work(100.0));
        servo.change_to(2);
        servo.saw.clear();
        servo.stroke(22.0, 90.0, rate, -1.0);
        servo.stroke(-22.0, 90.0, rate, -1.0);
        (servo.saturated, widening(&servo.saw, -1.0))
    };
    let (sane_saturates, sane) = tapped(250.0); // 16 N·m
    let (steep_saturates, steep) = tapped(540.0); // 34 N·m at 5400 rpm would be 19 kW
    assert!(!sane_saturates && steep_saturates);
    assert!(steep > 3.0 * sane, "{steep} mm against {sane} mm");
}

#[test]
fn a_finer_physics_step_changes_the_thread_by_less_than_a_tenth_of_a_micrometre() {
    let tapped = |step_us: f64| {
        let mut servo =
            Servo::new(Config { substep: Time::s(step_us * 1e-6), ..over_the_work(100.0) });
        servo.change_to(2);
        servo.saw.clear();
        servo.stroke(14.0, 50.0, 250.0, -1.0);
        servo.stroke(-14.0, 50.0, 250.0, -1.0);
        widening(&servo.saw, -1.0)
    };
    let (usual, fine) = (tapped(25.0), tapped(5.0));
    assert!((usual - fine).abs() < 0.1e-3, "{usual} mm, {fine} mm");
}

#[test]
fn a_tap_on_bare_metal_breaks_and_the_spindle_goes_on() {
    let mut config = over_the_work(100.0);
    config.stock.as_mut().expect("the fixture has work").assume_predrilled = false;
    let mut servo = Servo::new(config);
    servo.change_to(2);
    servo.stroke(10.0, 20.0, 100.0, -1.0);
    servo.rest(0.1);
    let truth = servo.machine.truth().unwrap();
    assert!(truth.tool_broken);
    assert_eq!(truth.cutting_force, Force::ZERO);
    assert!((truth.spindles[0].value() - 10.0).abs() < 1e-3);
}

//! A tap through the wire, beside the same tap of the simulated machine in the servo process.
use crate::ethercat_drives::bench::{
    OnWire, ask, encoders_are_absolute, home, homed, of_a_millisecond, until,
};
use crate::ethercat_drives::wire::Moment;
use bus::{Command, Feedback, Machine as _, Report};
use control::drives::simulated;
use control::job::{ProgramOptions, Session};
use control::operation::{Execution, Request};
use control::{Control, config};
use shm::{Fieldbus, ServoProcess, ServoProcessOptions, WriteTo};
use sim::SimulatedMachine;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use test_support::drives::DrivesBench;
use units::Time;

/// An M6 in the block that is clamped, from a mm above it.
const TAP: &str =
    "T3 M6\nG54 G90 G43 H3 G0 X12 Y12 Z30\nS3000 M3\nG99 G84 X12 Y12 Z-12 R5 F3000\nG80\nM5";
/// What a count is at the tool, mm.
const COUNT_MM: f64 = 16.0 / 8_388_608.0;
/// Where Z is in the thread, mm in machine coordinates.
const THREAD_MM: std::ops::Range<f64> = -207.0..-195.0;
/// Speed from which setpoints tell that axis and spindle are coupled, mm a period.
const MOVES_MM: f64 = 1e-3;

/// A tap is run to its end.
fn tap(control: &mut Control) {
    ask(control, &Request::ManualDataInput(TAP.into()));
    until(control, "the tap is done", |control| {
        control.execution() != Execution::Active && control.is_at_standstill()
    });
    assert!(control.stopped_by().is_none(), "{:?}", control.status().alarms);
}

/// Periods of axis and spindle in the thread, and how far the helices are from one another that
/// they were told and that the tool was on, mm.
fn of_thread(moments: &[Moment]) -> (usize, f64, f64) {
    let coupled = moments.windows(2).filter_map(|pair| {
        let [before, now] = pair else { return None };
        let (dz, turned) =
            (now.z_setpoint - before.z_setpoint, now.turn_setpoint - before.turn_setpoint);
        let is_tied = dz.abs() > MOVES_MM && (dz + turned).abs() < 1e-5;
        (is_tied && THREAD_MM.contains(&now.z)).then_some(now)
    });
    let coupled: Vec<_> = coupled.collect();
    assert!(coupled.len() > 500, "{} periods of {} are coupled", coupled.len(), moments.len());
    let spread = |places: &dyn Fn(&Moment) -> f64| {
        let places = coupled.iter().map(|moment| places(moment));
        let (least, most) = places.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
        most - least
    };
    let told = spread(&|moment| moment.z_setpoint + moment.turn_setpoint);
    (coupled.len(), told, spread(&|moment| moment.z + moment.turn))
}

/// The simulated machine in the place of a fieldbus, recorded.
struct Recorded {
    machine: SimulatedMachine,
    /// Setpoints of Z and of the spindle that are on their way, the oldest first.
    under_way: [(f64, f64); 2],
    moments: Arc<Mutex<Vec<Moment>>>,
}

impl Fieldbus for Recorded {
    fn read(&mut self, time: Time) -> Feedback {
        Feedback { time, ..*self.machine.feedback() }
    }

    fn write(&mut self, command: &Command, _: &Report, to: &WriteTo) {
        self.machine.exchange(command);
        let truth = self.machine.truth().copied().unwrap_or_default();
        let (z, spindle) = (&command.axes[2], &command.spindles[0]);
        let z_setpoint = z.position.value() + z.speed.value() * to.obeys_after[2].value();
        let turn_setpoint = (spindle.angle + spindle.spin * to.spindles_obey_after[0]).value();
        let [taken, next] = self.under_way;
        self.under_way = [next, (z_setpoint, turn_setpoint)];
        self.moments.lock().unwrap().push(Moment {
            enabled: z.enable,
            z_setpoint: taken.0,
            turn_setpoint: taken.1,
            z: truth.axes[2].value(),
            turn: truth.spindles[0].value(),
        });
    }

    fn off(&mut self) {
        let tool = self.machine.feedback().tool.unwrap_or(0);
        self.machine.exchange(&Command { tool, ..Command::default() });
    }

    fn now_ns(&self) -> i64 {
        (self.machine.feedback().time.value() * 1e9) as i64
    }
}

/// The same tap without a wire.
fn simulated_tap() -> Vec<Moment> {
    let session =
        Session::load(&ProgramOptions::on(encoders_are_absolute()), Path::new("-"), b"").unwrap();
    let file = session.machine.clone();
    let (material, zero) = (file.setup.stock.material, session.work_zero());
    let simulated = config::simulator(&file, &session.tools, material, 1, &zero);
    let machine = simulated::build(&file, simulated::switched_on(simulated)).unwrap();
    let moments = Arc::<Mutex<Vec<Moment>>>::default();
    let name = format!("simulated-{}", std::process::id());
    let options = ServoProcessOptions {
        name: name.clone(),
        machine: Some(file.name.clone()),
        axes: std::array::from_fn(|index| file.axes[index].is_some()),
        spindles: 1,
        not_called: "not called",
        axis_missing: |_| "there is none".into(),
        undriven: |names| format!("there is no {names}"),
    };
    let recorded = Recorded { machine, under_way: [(0.0, 0.0); 2], moments: Arc::clone(&moments) };
    let mut process = ServoProcess::new(recorded, options).unwrap();
    let stop = Arc::<AtomicBool>::default();
    let told = Arc::clone(&stop);
    let thread = std::thread::Builder::new().spawn(move || {
        while !told.load(Relaxed) {
            process.update(250_000);
            std::thread::sleep(Duration::from_micros(20));
        }
    });
    let folder = tempfile::tempdir().unwrap();
    let mut control = Control::new(control::ControlOptions {
        drives: format!("process:{name}").parse().unwrap(),
        state: Some(folder.path().join("state")),
        ..control::ControlOptions::simulated(ProgramOptions::on(encoders_are_absolute()))
    })
    .unwrap();
    home(&mut control);
    moments.lock().unwrap().clear();
    tap(&mut control);
    let moments = std::mem::take(&mut *moments.lock().unwrap());
    drop(control);
    stop.store(true, Relaxed);
    thread.unwrap().join().unwrap();
    moments
}

#[test]
fn a_tap_over_the_wire_is_that_of_the_simulated_machine_but_for_the_counts() {
    let bench = OnWire::of(encoders_are_absolute());
    let mut control = homed(&bench);
    bench.moments();
    tap(&mut control);
    let (periods, told, away) = of_thread(&bench.moments());
    let (expected, simulated_told, simulated_away) = of_thread(&simulated_tap());
    eprintln!(
        "{periods} and {expected} periods; helices told by {:.4} µm and {:.4} µm, cut by {:.3} µm and {:.3} µm",
        told * 1e3,
        simulated_told * 1e3,
        away * 1e3,
        simulated_away * 1e3
    );
    // where in a period the tap begins is the control's chance
    assert!(periods.abs_diff(expected) <= 2, "{periods} periods, simulated {expected}");
    assert!(told <= simulated_told + 2.0 * COUNT_MM, "{told} mm, simulated {simulated_told} mm");
    assert!(away < simulated_away + 5e-4, "{away} mm, simulated {simulated_away} mm");
}

#[test]
fn a_machine_with_a_frame_a_millisecond_is_homed_and_taps() {
    let bench = OnWire::of(of_a_millisecond());
    let mut control = homed(&bench);
    tap(&mut control);
}

/// How far helices are apart where frames are lost in the thread.
fn away_with_lost(before_devices: bool, frames: usize) -> f64 {
    let bench = OnWire::start();
    let mut control = homed(&bench);
    bench.moments();
    bench.lose_in_tap(before_devices, frames);
    tap(&mut control);
    let (.., away) = of_thread(&bench.moments());
    assert!(bench.has_lost(), "no frame was lost");
    away
}

#[test]
fn a_frame_that_is_lost_in_a_tap_leaves_the_tool_within_a_micrometre_of_its_way() {
    let whole = away_with_lost(false, 0);
    for before_devices in [false, true] {
        let away = away_with_lost(before_devices, 1);
        eprintln!("{:.3} µm, without a loss {:.3} µm", away * 1e3, whole * 1e3);
        assert!((away - whole).abs() < 1e-3, "{away} mm, without a loss {whole} mm");
    }
}

#[test]
fn four_frames_in_a_row_that_are_lost_in_a_tap_stop_it_and_recovery_takes_the_tap_out() {
    let bench = OnWire::start();
    let mut control = homed(&bench);
    bench.lose_in_tap(true, 4);
    ask(&mut control, &Request::ManualDataInput(TAP.into()));
    until(&mut control, "it has stopped", |control| {
        control.stopped_by().is_some() && control.is_at_standstill()
    });
    let alarms = format!("{:?}", control.status().alarms);
    assert!(alarms.contains("106"), "{alarms}");
    assert!(control.is_tool_in_work(), "{alarms}");
    drop(control);
    let mut bench = bench;
    bench.without_control();
    let mut next = Control::new(bench.options()).unwrap_or_else(|why| panic!("{why}"));
    assert!(next.is_tool_in_work());
    ask(&mut next, &Request::Recover);
    until(&mut next, "the tap is out", |control| !control.is_tool_in_work());
    assert!(bench.z_mm() > -195.0, "the tap was left at {} mm", bench.z_mm());
}

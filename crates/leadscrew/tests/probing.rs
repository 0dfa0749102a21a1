//! Probing finds the simulated work wherever it really lies: faces, bores, bosses, in millimetres
//! and inches, on several machines. What is found is true if the probe then stands where the work
//! really is: within 2 µm where the axes have scales. A motor's encoder does not see the wobble of
//! its screw, 3 µm to each side (`[simulation.plant]`), at the two contacts and where the axis goes
//! to in the end; no probing can.
use bus::Sample;
use control::observers::Observer;
use kernel::Event;
use leadscrew::{Finished, Job, Program, ProgramOptions, Run, RunOptions};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use store::machine::Round;
use units::Length;

/// A machine with scales on its axes.
const SCALES: &str = "tapping-center-scale";
/// Where the ball may be off after a touch-off, and what a diameter may be off.
const MOST_MM: f64 = 0.002;
/// The same where screws wobble.
const BY_SCREWS_MM: f64 = 0.002 + 2.0 * 0.003;
const PROBE_LENGTH_MM: f64 = 120.0;
/// How far the work lies from where the set-up has it, X, Y, Z.
const SHIFT_MM: [f64; 3] = [1.234, -0.871, 0.456];

/// Keeps the last sample.
#[derive(Clone, Default)]
struct Last(Arc<Mutex<Sample>>);

impl Observer for Last {
    fn sample(&mut self, sample: &Sample) {
        *self.0.lock().unwrap() = *sample;
    }
    fn event(&mut self, _: &Event) {}
}

fn round(x: f64, y: f64, diameter: f64, height: f64) -> Round {
    let [x, y, diameter, height] = [x, y, diameter, height].map(Length::mm);
    Round { at: [x, y], diameter, height }
}

/// A program with the probe in the spindle over a work with a ring of 30 mm at X40 Y30, which lies
/// elsewhere by so much.
fn job(machine: &str, lines: &str, shift: [f64; 3]) -> Job {
    let programs = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../programs");
    let options = ProgramOptions {
        tools: Some(programs.join("tools.toml")),
        subprograms: vec![programs],
        ..ProgramOptions::on(machine)
    };
    let text = format!("G21 G90 G17 G54\nT20 M6\nG43 H20\n{lines}\nG4 P0.5\nM2\n");
    let mut job = Program::of("probing", text).on(options).unwrap();
    let file = &mut job.session.machine;
    file.simulation.work_shift = shift.map(Length::mm);
    file.setup.holes = vec![round(40.0, 30.0, 30.0, 15.0), round(-30.0, -20.0, 47.3, 20.0)];
    file.setup.bosses = vec![round(-40.0, 45.0, 24.7, 12.0)];
    job
}

/// What came of it, and where the ball's lower end stands in the work as it really lies, mm.
fn run(job: Job) -> (Finished, [f64; 3]) {
    let zero = job.session.work_zero().linear.map(Length::value);
    let shift = job.session.machine.simulation.work_shift.map(Length::value);
    let top = job.session.machine.setup.stock.to[2].value();
    let mut run = Run::prepare(job, &RunOptions::default()).unwrap_or_else(|_| panic!("not ready"));
    let last = Last::default();
    run.observers.push(Box::new(last.clone()));
    run.prove(&mut |_| ()).unwrap_or_else(|refused| panic!("{}", refused.sentence()));
    let finished = run.execute(&mut |_| ()).unwrap();
    let said = (&finished.outcome.faults, &finished.outcome.broke_off);
    assert!(finished.outcome.ended, "{said:?}");
    let sample = *last.0.lock().unwrap();
    let at = [0, 1, 2].map(|i| sample.axis(i).value() - zero[i] - shift[i]);
    (finished, [at[0], at[1], at[2] - PROBE_LENGTH_MM - top])
}

fn parameter(finished: &Finished, number: usize) -> f64 {
    finished.left().unwrap().parameters.get(number).unwrap()
}

#[track_caller]
fn near(found: f64, exact: f64) {
    within(MOST_MM, found, exact);
}

#[track_caller]
fn within(most: f64, found: f64, exact: f64) {
    assert!((found - exact).abs() < most, "{found}, {exact}: {:.2} µm", (found - exact) * 1e3);
}

const CALIBRATE: &str = "G0 X40 Y30 Z20\nG0 Z-3\no<probe-calibrate> call [30] [0]\nG0 Z20\n";

/// What a calibration on this machine leaves in #4011 and #4012, as lines of a program.
fn calibrated(machine: &str) -> String {
    let (finished, _) = run(job(machine, CALIBRATE, [0.0; 3]));
    let [radius, along] = [4011, 4012].map(|number| parameter(&finished, number));
    assert!((radius - 2.988).abs() < 0.005, "the ball's radius less the pretravel: {radius}");
    assert!((along - 0.012).abs() < 0.003, "the pretravel: {along}");
    format!("#4011={radius}\n#4012={along}\n")
}

#[test]
fn touching_off_faces_puts_the_work_offset_where_the_work_really_lies() {
    let machines =
        [(SCALES, MOST_MM), ("tapping-center", BY_SCREWS_MM), ("mill-5-axis", BY_SCREWS_MM)];
    for (machine, most) in machines {
        let lines = calibrated(machine)
            + "G0 X0 Y0 Z20\no<probe-face> call [2] [-1] [30]\nG10 L20 P0 Z[#5422-#<_probe_face>]\n\
               G0 X215\nG0 Z-5\no<probe-face> call [0] [-1] [25]\nG10 L20 P0 X[#5420-#<_probe_face>+200]\n\
               G0 Z20\nG0 X190\nG1 Z2 F500\n";
        let (_, at) = run(job(machine, &lines, SHIFT_MM));
        within(most, at[0], 190.0);
        within(most, at[2], 2.0);
    }
}

#[test]
fn a_bore_is_found_with_its_middle_and_its_diameter() {
    let lines = calibrated(SCALES)
        + "G0 X-30 Y-20 Z20\nG0 Z-4\no<probe-bore> call [47]\n#100=#<_bore_diameter>\n\
           G10 L20 P0 X[#5420-#<_bore_x>] Y[#5421-#<_bore_y>]\nG0 X0 Y0\n";
    let (finished, at) = run(job(SCALES, &lines, SHIFT_MM));
    near(at[0], -30.0);
    near(at[1], -20.0);
    near(parameter(&finished, 100), 47.3);
}

#[test]
fn a_boss_is_found_from_outside() {
    let lines = calibrated(SCALES)
        + "G0 X-40 Y45 Z30\nG0 Z20\no<probe-boss> call [25] [15]\n#100=#<_boss_diameter>\n\
           G10 L20 P0 X[#5420-#<_boss_x>] Y[#5421-#<_boss_y>]\nG0 X0 Y0\n";
    let (finished, at) = run(job(SCALES, &lines, SHIFT_MM));
    near(at[0], -40.0);
    near(at[1], 45.0);
    near(parameter(&finished, 100), 24.7);
}

#[test]
fn an_inch_program_finds_the_same_place() {
    let lines = calibrated(SCALES)
        + "G20\nG0 X[-30/25.4] Y[-20/25.4] Z1\nG0 Z-0.15\no<probe-bore> call [1.85]\n#100=#<_bore_diameter>\n\
           G10 L20 P0 X[#5420-#<_bore_x>] Y[#5421-#<_bore_y>]\nG0 X0 Y0\n";
    let (finished, at) = run(job(SCALES, &lines, SHIFT_MM));
    near(at[0], -30.0);
    near(at[1], -20.0);
    near(parameter(&finished, 100) * 25.4, 47.3);
}

#[test]
fn a_work_that_is_not_there_is_an_alarm_and_none_where_the_program_asks() {
    let low = [0.0, 0.0, -15.0];
    let job_of = |code| job("tapping-center", &format!("G0 X0 Y0 Z20\n{code} Z-10 F300"), low);
    let mut missing = job_of("G38.2");
    missing.check();
    let finished = missing.run(&RunOptions::default()).unwrap();
    assert_eq!(finished.outcome.faults[0].kind, kernel::FaultKind::ProbeNotReached);
    let (finished, _) = run(job_of("G38.3"));
    near(parameter(&finished, 5070), 0.0);
}

#[test]
fn a_rapid_into_a_work_that_lies_higher_than_it_should_is_stopped_by_the_probe() {
    let lines = "G0 X0 Y0 Z20\nG0 Z1";
    let finished = job("tapping-center", lines, [0.0, 0.0, 3.0]).run(&RunOptions::default());
    let finished = finished.unwrap();
    assert_eq!(finished.outcome.faults[0].kind, kernel::FaultKind::ProbeContact);
}

#[test]
fn a_machine_without_a_probe_refuses_to_probe_before_anything_moves() {
    let mut job = job("tapping-center", "G38.2 Z-10 F300", [0.0; 3]);
    job.session.machine.probe = None;
    let errors: Vec<_> = job.check().iter().filter(|f| f.is_error()).map(|f| f.code).collect();
    assert_eq!(errors, ["M0372"]);
}

//! Faults of feedback in every activity of a program: no axis goes further than it may, and what is
//! said of it is true.
//!
//! ```text
//!   program, machine, instant, fault ─► run ─┬─► the bus after the alarm: force, enable, followed to rest
//!                                            ├─► where each axis really went, against the bound
//!                                            └─► the summary, against the simulator's truth
//! ```
#![allow(clippy::unwrap_used)] // a test may panic
use bus::{AXES, SPINDLES, Sample, State};
use control::observers::Observer;
use control::stops::AfterStop;
use kernel::Event;
use leadscrew::{Finished, Job, Program, ProgramOptions, Run, RunOptions};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

/// An activity: a short program on a machine, and between which seconds it is under way.
struct Activity {
    name: &'static str,
    machine: &'static str,
    text: &'static str,
    from_s: f64,
    to_s: f64,
    axes: &'static str,
}

const ACTIVITIES: &[Activity] = &[
    Activity {
        name: "rapid",
        machine: "tapping-center",
        text: "G21 G90 G54\nG0 X0 Y0 Z100\nG0 X180 Y120\nG0 X-180 Y-120\nG0 X180 Y120 Z20\nG0 X-180 Y-120 Z150\nG0 X0 Y0 Z20\nM2\n",
        from_s: 0.1,
        to_s: 3.0,
        axes: "XYZ",
    },
    Activity {
        name: "feed",
        machine: "tapping-center",
        text: "G21 G90 G54\nG0 X0 Y0 Z20\nF20000\nG64 P0.05\nG1 X150\nG2 X150 Y100 I0 J50\nG1 X-150\nG2 X-150 Y0 I0 J-50\nG1 X0 Z60\nM2\n",
        from_s: 0.3,
        to_s: 3.0,
        axes: "XYZ",
    },
    Activity {
        name: "tap M6 S6000",
        machine: "tapping-center",
        text: TAP_M6,
        from_s: 6.1,
        to_s: 7.6,
        axes: "XYZ",
    },
    Activity {
        name: "tap M6 S6000, scales",
        machine: "tapping-center-scale",
        text: TAP_M6,
        from_s: 6.1,
        to_s: 7.6,
        axes: "XYZ",
    },
];

const TAP_M6: &str = "G21 G90 G54 G17 G94\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z20\nG99 G81 X0 Y0 Z-20 R5 F600\nG80\nT3 M6\nG43 H3\nS6000 M3\nG0 X0 Y0 Z20\nG99 G84 X0 Y0 Z-15 R5 F6000\nG80\nG0 Z50\nM2\n";

/// What is kept of a run.
#[derive(Default)]
struct Seen {
    samples: Vec<Sample>,
    from_s: f64,
}

/// Keeps the samples from an instant on.
#[derive(Clone)]
struct Keeper(Arc<Mutex<Seen>>);

impl Observer for Keeper {
    fn sample(&mut self, sample: &Sample) {
        let mut seen = self.0.lock().unwrap();
        if sample.feedback.time.value() >= seen.from_s {
            seen.samples.push(*sample);
        }
    }
    fn event(&mut self, _: &Event) {}
}

fn job(activity: &Activity) -> Job {
    let programs = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../programs");
    let options = ProgramOptions {
        tools: Some(programs.join("tools.toml")),
        ..ProgramOptions::on(activity.machine)
    };
    Program::of(activity.name, activity.text).on(options).unwrap()
}

fn run(
    activity: &Activity,
    seed: u64,
    faults: Vec<String>,
    from_s: f64,
) -> (Finished, Vec<Sample>) {
    let options = RunOptions {
        seed: Some(seed),
        faults,
        recover: Some(AfterStop::Out),
        ..RunOptions::default()
    };
    let mut run = Run::prepare(job(activity), &options).unwrap_or_else(|_| panic!("not ready"));
    let keeper = Keeper(Arc::new(Mutex::new(Seen { from_s, ..Seen::default() })));
    run.observers.push(Box::new(keeper.clone()));
    run.prove(&mut |_| ()).unwrap_or_else(|refused| panic!("{}", refused.sentence()));
    let finished = run.execute(&mut |_| ()).unwrap();
    let samples = std::mem::take(&mut keeper.0.lock().unwrap().samples);
    (finished, samples)
}

#[test]
fn timetable() {
    for activity in ACTIVITIES {
        let begun = std::time::Instant::now();
        let (finished, samples) = run(activity, 1, vec![], 0.0);
        println!("{}: {:?} {:?}", activity.name, finished.outcome.faults, begun.elapsed());
        let mut last = None;
        for s in &samples {
            if last != Some(s.report.state) {
                println!(
                    "  {:.3} {:?} {:?}",
                    s.feedback.time.value(),
                    s.report.state,
                    [0, 1, 2].map(|i| s.axis(i).value())
                );
                last = Some(s.report.state);
            }
        }
        println!("  end {:.3}", samples.last().unwrap().feedback.time.value());
    }
}

#[test]
fn probe() {
    let fault = std::env::var("FAULT").unwrap();
    let which = std::env::var("ACTIVITY").unwrap();
    let seed = std::env::var("SEED").map_or(1, |s| s.parse().unwrap());
    let at: f64 = fault.split("at ").nth(1).unwrap().trim_end_matches('s').parse().unwrap();
    for activity in ACTIVITIES.iter().filter(|a| a.name.contains(&which)) {
        let (finished, samples) = run(activity, seed, vec![fault.clone()], at - 0.002);
        let first = samples[0];
        for (k, s) in samples.iter().enumerate() {
            if (std::env::var("ALL").is_ok() && k < 800 && k % 8 == 0) || k < 60 || k % 400 == 0 {
                let t = s.truth.unwrap();
                println!(
                    "{:.5} {:?} d {:?} f {:?} en {:?} spin {:.1} M {:.2} en {} broken {}",
                    s.feedback.time.value(),
                    s.report.state,
                    [0, 1, 2].map(|i| ((s.axis(i) - first.axis(i)).value() * 1e3).round()),
                    [0, 1, 2].map(|i| s.command.axes[i].force.value().round()),
                    [0, 1, 2].map(|i| s.command.axes[i].enable),
                    t.spins[0].value(),
                    s.command.spindles[0].torque.value(),
                    s.command.spindles[0].enable,
                    t.tool_broken
                );
            }
        }
        println!(
            "{:?}\n{}",
            finished.outcome.faults,
            control::stops::text(
                &finished.outcome.stops,
                &finished.outcome.happened,
                &finished.outcome.withdrawn
            )
        );
    }
}

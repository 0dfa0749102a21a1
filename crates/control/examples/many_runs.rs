//! Memory and open files of a control that runs programs one after another, and is asked for much
//! between and within them: `cargo run -p control --release --example many_runs -- 2000`.
//!
//! It runs a program of 36 holes on one workpiece, a minute of machine time. In each run the
//! feed is held and gone on with, and changed; between two of them an axis is jogged, a block
//! executed, an offset set, a tool limited. Written are machine time, requests, resident memory and
//! open files of the process, ten times on the way.
use canon::Axis;
use control::job::ProgramOptions;
use control::operation::{Execution, Jog, Request};
use control::{Control, ControlOptions};
use std::fmt::Write as _;
use units::{Coordinate, Time};

/// Resident memory, MB.
fn resident_mb() -> f64 {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = statm.split_whitespace().nth(1).and_then(|pages| pages.parse::<f64>().ok());
    pages.unwrap_or(0.0) * 4096e-6
}

/// Number of files that the process has open.
fn descriptors() -> usize {
    std::fs::read_dir("/proc/self/fd").map_or(0, Iterator::count)
}

/// Holes in a grid, shallow so that they take little machine time.
fn program() -> String {
    let mut text =
        "G21 G90 G54 G17 G94\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z5\nG99 G81 X0 Y0 Z-3 R1 F200\n"
            .to_owned();
    for hole in 1..36 {
        // writing to a String cannot fail
        let _ = writeln!(text, "X{} Y{}", hole % 6 * 10, hole / 6 * 10);
    }
    text.push_str("G80\nG0 Z50\nM2\n");
    text
}

fn until(control: &mut Control, is_so: impl Fn(&Control) -> bool) {
    while !is_so(control) {
        control.period();
        while control.next_event().is_some() {}
    }
}

fn ask(control: &mut Control, request: &Request) -> Result<(), String> {
    control.request(request).map(drop).map_err(|why| format!("{request:?}: {why}"))
}

/// Runs the program, with a hold on the way; how much was asked for.
fn cut(control: &mut Control, run: u32) -> Result<u32, String> {
    ask(control, &Request::FeedOverride(0.5 + f64::from(run % 8) * 0.1))?;
    ask(control, &Request::Start)?;
    let hold = control.now() + Time::s(1.0 + f64::from(run % 200) * 0.1);
    until(control, |control| control.now() >= hold);
    ask(control, &Request::FeedHold)?;
    let go_on = control.now() + Time::s(0.5);
    until(control, |control| control.now() >= go_on);
    // a run that waits for its spindle or its tool has nothing to hold
    let resumed = control.execution() == Execution::FeedHold;
    if resumed {
        ask(control, &Request::Resume)?;
    }
    until(control, |control| control.execution() == Execution::ProgramCompleted);
    Ok(3 + u32::from(resumed))
}

/// What is asked for between two runs; how much.
fn between(control: &mut Control, run: u32) -> Result<u32, String> {
    let step = if run.is_multiple_of(2) { 3.0 } else { -3.0 };
    ask(control, &Request::Jog(Axis::X, Jog::Increment(Coordinate::new(step))))?;
    until(control, |control| !control.is_moving_manually() && control.is_at_standstill());
    ask(control, &Request::ManualDataInput("G53 G0 Z0".into()))?;
    until(control, |control| !control.execution().is_under_way());
    ask(control, &Request::SetWorkOffset(2, Axis::X, Coordinate::new(-f64::from(run % 100))))?;
    ask(control, &Request::LimitTool(2, Some(1_000_000 + run)))?;
    Ok(4)
}

fn main() -> Result<(), String> {
    let runs: u32 = std::env::args().nth(1).and_then(|runs| runs.parse().ok()).unwrap_or(20);
    let home = std::env::temp_dir().join(format!("leadscrew-many-runs-{}", std::process::id()));
    std::fs::create_dir_all(&home).map_err(|e| e.to_string())?;
    let path = home.join("part.ngc");
    std::fs::write(&path, program()).map_err(|e| e.to_string())?;
    let options = ControlOptions {
        state: Some(home.join("state")),
        ..ControlOptions::simulated(ProgramOptions::from("tapping-center"))
    };
    let mut control = Control::new(options).map_err(|why| why.to_string())?;
    ask(&mut control, &Request::Power(true))?;
    until(&mut control, Control::is_ready);
    ask(&mut control, &Request::Home(None))?;
    until(&mut control, |control| control.is_homed_all() && control.is_at_standstill());
    ask(&mut control, &Request::Load(path))?;
    let mut requests = 3;
    for run in 1..=runs {
        requests += cut(&mut control, run)? + between(&mut control, run)?;
        if run == 1 || run % (runs / 10).max(1) == 0 {
            let status = control.status();
            let count = status.features.good + status.features.failed + status.features.not_judged;
            let hours = control.now().value() / 3600.0;
            let (listed, mb, open) = (control.features().len(), resident_mb(), descriptors());
            println!(
                "{run:>6} runs {hours:>6.2} h {requests:>7} requests {count:>8} features {listed:>7} listed {mb:>7.1} MB {open:>4} open"
            );
        }
    }
    drop(control);
    std::fs::remove_dir_all(&home).map_err(|e| e.to_string())
}

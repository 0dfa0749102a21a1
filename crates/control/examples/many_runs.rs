//! Memory of a control that runs programs one after another: `cargo run -p control --release
//! --example many_runs -- 2000`.
//!
//! It runs a program of 36 holes on one workpiece, and writes the resident memory of the process
//! after so many runs.
use control::job::ProgramOptions;
use control::operation::{Execution, Request};
use control::{Control, ControlOptions};
use std::fmt::Write as _;

/// Resident memory, MB.
fn resident_mb() -> f64 {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = statm.split_whitespace().nth(1).and_then(|pages| pages.parse::<f64>().ok());
    pages.unwrap_or(0.0) * 4096e-6
}

/// Holes in a grid, shallow so that they take little machine time.
fn program() -> String {
    let mut text =
        "G21 G90 G54 G17 G94\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z5\nG99 G81 X0 Y0 Z-3 R1 F900\n"
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
    let ask = |control: &mut Control, request: &Request| {
        control.request(request).map(drop).map_err(|why| why.to_string())
    };
    ask(&mut control, &Request::Power(true))?;
    until(&mut control, Control::is_ready);
    ask(&mut control, &Request::Home(None))?;
    until(&mut control, |control| control.is_homed_all() && control.is_at_standstill());
    ask(&mut control, &Request::Load(path))?;
    println!("{:>6} runs {:>8} features {:>7} listed {:>7} MB", 0, 0, 0, resident_mb().round());
    for run in 1..=runs {
        ask(&mut control, &Request::Start)?;
        until(&mut control, |control| control.execution() == Execution::ProgramCompleted);
        if run == 1 || run % (runs / 10).max(1) == 0 {
            let status = control.status();
            let count = status.features.good + status.features.failed + status.features.not_judged;
            let (listed, mb) = (control.features().len(), resident_mb());
            println!("{run:>6} runs {count:>8} features {listed:>7} listed {mb:>7.1} MB");
        }
    }
    drop(control);
    std::fs::remove_dir_all(&home).map_err(|e| e.to_string())
}

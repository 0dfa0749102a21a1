//! Memory and open files of a control that runs programs one after another, and is asked for much
//! between and within them: `cargo run -p control --release --example many_runs -- 2000`.
//!
//! It runs a program of 36 holes on one workpiece, a minute of machine time. In each run the
//! feed is held and gone on with, and changed; between two of them an axis is jogged, a block
//! executed, an offset set, a tool limited. Written are machine time, requests, resident memory and
//! open files of the process, ten times on the way.
//!
//! Every tenth time a second control, a process with a state folder of its own that does the same
//! without end, is killed at a random instant (SIGKILL) and started again:
//!
//! ```text
//!   second control:  set 41 ─ set 42 ─ set 43 ✗       up 43 ─ set 44 …
//!                            each is on the disk ──────┘ no less, no alarm 601, no file left behind
//! ```
use canon::Axis;
use control::job::ProgramOptions;
use control::operation::{Execution, Jog, Request};
use control::{Control, ControlOptions};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use units::{Coordinate, Time};

/// The first argument of the second control.
const KILLED: &str = "--killed";
/// Runs of the first control between two kills of the second one.
const RUNS_A_KILL: u32 = 10;
/// The second control is killed within this time of its start, ms.
const LIFE_MS: u64 = 1500;
/// Offset by which a number is kept, mm.
const STEP_MM: f64 = -0.001;

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

/// A control with this state folder, ready, homed and with the program loaded.
fn ready(state: &Path, program: &Path) -> Result<Control, String> {
    let options = ControlOptions {
        state: Some(state.to_owned()),
        ..ControlOptions::simulated(ProgramOptions::from("tapping-center"))
    };
    let mut control = Control::new(options).map_err(|why| why.to_string())?;
    ask(&mut control, &Request::Power(true))?;
    until(&mut control, Control::is_ready);
    ask(&mut control, &Request::Home(None))?;
    until(&mut control, |control| control.is_homed_all() && control.is_at_standstill());
    ask(&mut control, &Request::Load(program.to_owned()))?;
    Ok(control)
}

/// The number that the state has: the zero of G55 and the limit of T2 are made of it.
fn number_kept(control: &Control) -> (u32, u32) {
    let zero = control.zero_of(2, Axis::X).value() / STEP_MM;
    let limit = control.tools().find(|tool| tool.number == 2).and_then(|tool| tool.life.limit.uses);
    (zero.round().max(0.0) as u32, limit.unwrap_or(1) - 1)
}

/// The second control: says what it has found, then keeps one number after another, and in between
/// cuts; what it says is on the disk.
fn go_on_until_killed(state: &Path, program: &Path) -> Result<(), String> {
    let mut control = ready(state, program)?;
    let say = |text: String| {
        let mut out = std::io::stdout().lock();
        writeln!(out, "{text}").and_then(|()| out.flush()).map_err(|e| e.to_string())
    };
    let ((offset, limit), status) = (number_kept(&control), control.status());
    let (changed, alarms) = (status.state_changes.len(), control.alarms().len());
    say(format!("up {offset} {limit} {changed} {alarms}"))?;
    let mut number = offset.max(limit);
    loop {
        for _ in 0..20 {
            number += 1;
            let zero = Coordinate::new(f64::from(number) * STEP_MM);
            ask(&mut control, &Request::SetWorkOffset(2, Axis::X, zero))?;
            ask(&mut control, &Request::LimitTool(2, Some(number + 1)))?;
            say(format!("set {number}"))?;
        }
        ask(&mut control, &Request::Start)?;
        until(&mut control, |control| control.execution() == Execution::ProgramCompleted);
    }
}

/// What is known of the second control.
#[derive(Default)]
struct Second {
    /// What it has acknowledged.
    number: u32,
    kills: u32,
    files: BTreeSet<String>,
    random: u64,
}

impl Second {
    /// Starts it, kills it, and compares what it has found with what it had said before.
    fn killed(&mut self, home: &Path, program: &Path) -> Result<(), String> {
        let state = home.join("killed");
        self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(99);
        let life = Duration::from_millis((self.random >> 33) % LIFE_MS);
        let own = std::env::current_exe().map_err(|e| e.to_string())?;
        let mut control = Command::new(own)
            .args([KILLED.as_ref(), state.as_os_str(), program.as_os_str()])
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| e.to_string())?;
        let out = control.stdout.take().ok_or("it has no output")?;
        let mut said = BufReader::new(out).lines().map_while(Result::ok);
        let up = said.next().ok_or("the second control has not come up")?;
        std::thread::sleep(life);
        control.kill().map_err(|e| e.to_string())?;
        control.wait().map_err(|e| e.to_string())?;
        let found: Vec<u32> = up.split(' ').filter_map(|word| word.parse().ok()).collect();
        let [offset, limit, changed, alarms] = found[..] else { return Err(up) };
        let is_kept = |found: u32| (self.number..=self.number + 1).contains(&found);
        if !is_kept(offset) || !is_kept(limit) || changed > 0 || alarms > 0 {
            return Err(format!("after kill {}: {up}; {} was kept", self.kills, self.number));
        }
        let set = said.filter_map(|line| line.strip_prefix("set ")?.parse().ok()).last();
        self.number = set.unwrap_or_else(|| offset.max(limit));
        self.kills += 1;
        let names = std::fs::read_dir(&state).map_err(|e| e.to_string())?;
        let names = names.flatten().map(|file| file.file_name().to_string_lossy().into_owned());
        self.files.extend(names);
        Ok(())
    }
}

fn main() -> Result<(), String> {
    let mut arguments = std::env::args().skip(1);
    let first = arguments.next();
    if let (Some(KILLED), Some(state), Some(program)) =
        (first.as_deref(), arguments.next(), arguments.next())
    {
        return go_on_until_killed(state.as_ref(), program.as_ref());
    }
    let runs: u32 = first.and_then(|runs| runs.parse().ok()).unwrap_or(20);
    let home = std::env::temp_dir().join(format!("leadscrew-many-runs-{}", std::process::id()));
    std::fs::create_dir_all(&home).map_err(|e| e.to_string())?;
    let path = home.join("part.ngc");
    std::fs::write(&path, program()).map_err(|e| e.to_string())?;
    let mut control = ready(&home.join("state"), &path)?;
    let (mut requests, mut second) = (3, Second { random: 7, ..Second::default() });
    for run in 1..=runs {
        requests += cut(&mut control, run)? + between(&mut control, run)?;
        if run.is_multiple_of(RUNS_A_KILL) {
            second.killed(&home, &path)?;
        }
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
    let Second { kills, number, files, .. } = second;
    println!("{kills} kills, {number} numbers kept, files of the state: {files:?}");
    drop(control);
    std::fs::remove_dir_all(&home).map_err(|e| e.to_string())
}

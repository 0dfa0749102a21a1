//! `cargo xtask bench-listing`: how fast a long program becomes canonical calls, and in how much
//! memory.
//!
//! The same program, one of each [kind](Kind), goes through `leadscrew canon --format linuxcnc` and
//! through LinuxCNC's `rs274 -g`, by turns in the same run, each into nowhere; the medians are
//! compared. First the two listings are compared in full, so that neither wins by doing less.
//! `--memory LINES` runs `canon` and `check` on that many lines of each kind and says the most
//! memory they held, and when the first byte came out.
#![allow(clippy::disallowed_methods)] // a bench measures: it has a clock

use crate::bench_programs::Kind;
use crate::listing::{calls, first_difference};
use crate::rs274::Rs274;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Times each is run.
const ROUNDS: usize = 3;
/// How many times as fast as LinuxCNC's Leadscrew is to be.
const GOAL: f64 = 10.0;
/// Most memory that a program of any length may need, MB.
const MEMORY_GOAL_MB: f64 = 50.0;

/// Measures on programs of about so many lines. A ratio below the goal is marked and fails nothing:
/// times of a shared machine are no verdict. A listing that differs is an error.
pub(crate) fn run(lines: usize) -> Result<bool, String> {
    let leadscrew = crate::leadscrew()?;
    let rs274 = Rs274::new()?;
    let folder = tempfile::tempdir().map_err(|e| format!("no temporary folder: {e}"))?;
    println!("| program | executed lines | leadscrew | rs274 -g | ratio (goal {GOAL}) |");
    println!("|---|---|---|---|---|");
    for kind in Kind::ALL {
        let lines = kind.lines(lines);
        let program = write(folder.path(), kind, lines)?;
        let ours = || canon(&leadscrew, &program);
        let theirs = || rs274.command(&program);
        let (a, b) = (listing(theirs())?, listing(ours())?);
        if let Some((call, a, b)) = first_difference(&a, &b) {
            return Err(format!("{}: call {call} differs:\n  {a}\n  {b}", kind.name()));
        }
        let (mut our_times, mut their_times) = (Vec::new(), Vec::new());
        for _ in 0..ROUNDS {
            our_times.push(time(ours())?);
            their_times.push(time(theirs())?);
        }
        let (our_time, their_time) = (median(our_times), median(their_times));
        let ratio = their_time / our_time;
        let missed = if ratio < GOAL { ", below the goal" } else { "" };
        println!(
            "| {} | {lines} | {:.1} ms | {:.1} ms | {ratio:.1}{missed} |",
            kind.name(),
            our_time * 1e3,
            their_time * 1e3
        );
    }
    Ok(true)
}

/// The most memory on so many lines, of `canon` and of `check`. False if it is more than it may be.
pub(crate) fn memory(lines: usize) -> Result<bool, String> {
    let leadscrew = crate::leadscrew()?;
    let folder = tempfile::tempdir().map_err(|e| format!("no temporary folder: {e}"))?;
    println!("| program of {lines} lines | command | most memory | first byte | time |");
    println!("|---|---|---|---|---|");
    let mut good = true;
    for kind in Kind::ALL {
        let program = write(folder.path(), kind, lines)?;
        let mut check = Command::new(&leadscrew);
        check.arg("check").arg(&program);
        for (name, command) in [("canon", canon(&leadscrew, &program)), ("check", check)] {
            let seen = watch(command)?;
            good &= seen.most_mb <= MEMORY_GOAL_MB;
            println!(
                "| {} | {name} | {:.1} MB | {:.0} ms | {:.2} s |",
                kind.name(),
                seen.most_mb,
                seen.first_byte_s * 1e3,
                seen.time_s
            );
        }
        fs::remove_file(&program).map_err(|e| e.to_string())?;
    }
    Ok(good)
}

fn write(folder: &Path, kind: Kind, lines: usize) -> Result<PathBuf, String> {
    let program = folder.join(format!("{kind:?}.ngc").to_lowercase());
    fs::write(&program, kind.program(lines)).map_err(|e| format!("{}: {e}", program.display()))?;
    Ok(program)
}

fn canon(leadscrew: &Path, program: &Path) -> Command {
    let mut command = Command::new(leadscrew);
    command.args(["canon", "--format", "linuxcnc"]).arg(program);
    command
}

fn listing(mut command: Command) -> Result<Vec<String>, String> {
    let output = command.stdout(Stdio::piped()).output().map_err(|e| shown(&command, &e))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(format!("{command:?} ended with {}: {said}", output.status));
    }
    Ok(calls(&String::from_utf8_lossy(&output.stdout)))
}

fn time(mut command: Command) -> Result<f64, String> {
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let start = Instant::now();
    let status = command.status().map_err(|e| shown(&command, &e))?;
    let seconds = start.elapsed().as_secs_f64();
    if status.success() { Ok(seconds) } else { Err(format!("{command:?} ended with {status}")) }
}

/// What was seen of a process.
struct Seen {
    most_mb: f64,
    first_byte_s: f64,
    time_s: f64,
}

/// Run a command to its end, reading what it says.
fn watch(mut command: Command) -> Result<Seen, String> {
    command.stdout(Stdio::piped()).stderr(Stdio::null()).stdin(Stdio::null());
    let start = Instant::now();
    let mut child = command.spawn().map_err(|e| shown(&command, &e))?;
    let mut out = child.stdout.take().ok_or("no output")?;
    let reader = std::thread::spawn(move || {
        let (mut bytes, mut first) = (vec![0; 1 << 16], None);
        while let Ok(count @ 1..) = out.read(&mut bytes) {
            let _ = count;
            first.get_or_insert_with(|| start.elapsed().as_secs_f64());
        }
        first
    });
    let mut most_kb = 0;
    while child.try_wait().map_err(|e| e.to_string())?.is_none() {
        most_kb = most_kb.max(held_kb(&child).unwrap_or(0));
        std::thread::sleep(Duration::from_millis(2));
    }
    let time_s = start.elapsed().as_secs_f64();
    let first = reader.join().map_err(|_| "the reader broke")?;
    Ok(Seen {
        most_mb: f64::from(most_kb) * 1024.0 * 1e-6,
        first_byte_s: first.unwrap_or(time_s),
        time_s,
    })
}

/// The most memory that a process has held so far, as Linux counts it.
fn held_kb(child: &Child) -> Option<u32> {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn shown(command: &Command, error: &std::io::Error) -> String {
    format!("{}: {error}", command.get_program().to_string_lossy())
}

//! Controls killed and mains cut in a tap, over processes, as often as you like; a table of what became of it.
//!
//! ```text
//!   leadscrew simulator … ◄── relay ◄── leadscrew run: an M8×1.25, 20 mm, 1000 rpm, right or left hand
//!            │ the mains      │ SIGKILL, at t
//!            ▼
//!   drives alone ─► leadscrew recover ─► out, at most 20 µm off the helix that was cut, tap whole?
//! ```
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use test_support::Relay;

/// Furthest off the helix on the way out, µm.
const OFF_HELIX_UM: f64 = 20.0;

/// What stops a run.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stop {
    Kill,
    PowerCut,
}

/// How a run is stopped: name, by what, and further options of the machine simulator.
const WAYS: [(&str, Stop, &[&str]); 8] = [
    ("SIGKILL, coupled stop", Stop::Kill, &[]),
    ("SIGKILL, quick stop", Stop::Kill, &["--on-link-loss", "quick-stop"]),
    ("SIGKILL, coasting", Stop::Kill, &["--on-link-loss", "coast"]),
    ("power cut, coupled stop", Stop::PowerCut, &[]),
    ("power cut, single turn", Stop::PowerCut, &["--single-turn"]),
    (
        "power cut, single turn, coasting",
        Stop::PowerCut,
        &["--single-turn", "--on-power-loss", "coast"],
    ),
    ("power cut, outputs off", Stop::PowerCut, &["--on-power-loss", "off"]),
    (
        "power cut, single turn, outputs off",
        Stop::PowerCut,
        &["--single-turn", "--on-power-loss", "off"],
    ),
];

/// What became of the cases of one way and hand.
#[derive(Default)]
struct Row {
    cases: u32,
    recovered: u32,
    nothing: u32,
    refused: u32,
    broken: u32,
    worst_um: f64,
    worst_before_um: f64,
    problems: Vec<String>,
}

/// Run `count` instants of each way and hand; whether nothing broke and nothing was refused without need.
pub(crate) fn run(binary: &Path, count: u32, seed: u64) -> bool {
    let mut good = true;
    let mut random = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    println!(
        "{:<34} {:>5} {:>6} {:>9} {:>7} {:>7} {:>6} {:>12} {:>12}",
        "", "hand", "cases", "recovered", "nothing", "refused", "broken", "before µm", "way out µm"
    );
    for (name, stop, options) in WAYS {
        for (hand, tool, turn) in [("right", 11, "M3"), ("left", 41, "M4")] {
            let mut row = Row::default();
            for case in 0..count {
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                // the tap is in its cycle from 1.75 s to 4.3 s
                let part = 2.55 / f64::from(count);
                let at = 1.75 + part * (f64::from(case) + (random % 1000) as f64 / 1000.0);
                trial(binary, (stop, at, options), (tool, turn), &mut row).unwrap_or_else(|why| {
                    row.problems.push(format!("{name}, {hand}, {at:.6} s: {why}"));
                });
            }
            println!(
                "{name:<34} {hand:>5} {:>6} {:>9} {:>7} {:>7} {:>6} {:>12.1} {:>12.1}",
                row.cases,
                row.recovered,
                row.nothing,
                row.refused,
                row.broken,
                row.worst_before_um,
                row.worst_um
            );
            for problem in &row.problems {
                println!("  {problem}");
            }
            good &= row.problems.is_empty() && row.broken == 0;
        }
    }
    good
}

/// A process that ends with its value.
struct Behind(Child);

impl Drop for Behind {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn trial(
    binary: &Path,
    (stop, at, options): (Stop, f64, &[&str]),
    (tool, turn): (u32, &str),
    row: &mut Row,
) -> Result<(), String> {
    row.cases += 1;
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let cycle = if turn == "M4" { "G74" } else { "G84" };
    let program = format!(
        "G21 G90 G54 G17\nT{tool} M6\nS1000 {turn}\nG0 X0 Y0\nG43 H{tool} Z20\nG99 {cycle} X0 Y0 Z-20 R5 F1250\nG80\nG0 Z50\nM2\n"
    );
    let tools = include_str!("../../programs/tools.toml").to_owned()
        + "\n[[tool]]\nnumber = 41\npocket = 41\nkind = \"tap\"\ndescription = \"M8 left hand, rigid collet\"\ndiameter_mm = 8.0\nlength_mm = 115.0\nthread = \"M8x1.25-LH\"\nchamfer_pitches = 2.5\nthread_length_mm = 30.0\nflute = \"spiral-flute\"\noversize_um = 45.0\nholder = { kind = \"rigid\", stiffness_n_per_um = 20.0 }\n";
    for (name, text) in [("part.ngc", &program), ("tools.toml", &tools)] {
        std::fs::write(folder.path().join(name), text).map_err(|e| e.to_string())?;
    }
    let leadscrew = |arguments: &[&str]| {
        let mut command = Command::new(binary);
        command.args(arguments).current_dir(folder.path()).stdin(Stdio::null());
        command
    };
    let answer = |arguments: &[&str]| -> Result<Value, String> {
        let output = leadscrew(arguments).output().map_err(|e| e.to_string())?;
        serde_json::from_slice(&output.stdout)
            .map_err(|e| format!("{e}: {}", String::from_utf8_lossy(&output.stderr)))
    };
    let mut listen =
        [&["simulator", "--listen", "simulator", "--tools", "tools.toml"][..], options].concat();
    let seconds = at.to_string();
    if stop == Stop::PowerCut {
        listen.extend(["--power-cut-at", &seconds]);
    }
    let mut simulator =
        Behind(leadscrew(&listen).stdout(Stdio::piped()).spawn().map_err(|e| e.to_string())?);
    let mut line = String::new();
    let said = simulator.0.stdout.take().ok_or("the machine simulator says nothing")?;
    BufReader::new(said).read_line(&mut line).map_err(|e| e.to_string())?;
    let run = ["run", "part.ngc", "--simulator", "simulator", "--state", "state", "-q"];
    let mut run = leadscrew(&run);
    let kills = if stop == Stop::Kill { &[at][..] } else { &[] };
    let relay = Relay::in_place_of(&folder.path().join("simulator"), kills);
    let relay = relay.map_err(|e| e.to_string())?;
    let output = relay.output(&mut run).map_err(|e| e.to_string())?;
    if output.status.success() {
        return Err("nothing stopped it".into());
    }
    let before = answer(&["simulator", "--status", "simulator"])?;
    let recovered =
        answer(&["recover", "--simulator", "simulator", "--state", "state", "--format", "json"])?;
    let after = answer(&["simulator", "--status", "simulator"])?;
    row.worst_before_um =
        row.worst_before_um.max(before["off_helix_um"].as_f64().unwrap_or(0.0).abs());
    if after["tool_broken"] != false {
        row.broken += 1;
        return Err(format!("the tap is broken: {recovered}"));
    }
    match recovered["outcome"].as_str() {
        Some("recovered") => {
            row.recovered += 1;
            let off = after["off_helix_while_coupled_max_um"].as_f64().unwrap_or(f64::INFINITY);
            row.worst_um = row.worst_um.max(off);
            if off > OFF_HELIX_UM {
                return Err(format!("{off:.1} µm off its helix on the way out"));
            }
        }
        Some("nothing-to-do") => row.nothing += 1,
        Some("refused") => {
            row.refused += 1;
            let reason = recovered["reason"].as_str().unwrap_or("");
            // without turns and without a bound there is nothing that could be shown
            let explained = options.contains(&"--single-turn") && reason.contains("half a lead");
            return if explained { Ok(()) } else { Err(format!("refused: {reason}")) };
        }
        _ => return Err(format!("no answer: {recovered}")),
    }
    if after["tap_in_thread"] == true {
        return Err(format!("the tap is still in: {recovered}"));
    }
    Ok(())
}

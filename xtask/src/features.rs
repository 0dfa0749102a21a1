//! Controls killed in everything that ties a tool to a spindle, with everything that drives do by themselves, over processes; what
//! became of the tool, and whether what `recover` said of it was true.
//!
//! ```text
//!   leadscrew simulator … --on-link-loss REACTION ◄── relay, which kills at t ◄── leadscrew run: pecks, threads, gears, …
//!            │ SIGKILL at t
//!            ▼
//!   drives alone ─► looked at: dry run, a refused run; no record, an old one, a foreign one ─► nothing may have changed
//!            ▼
//!   leadscrew recover ─► what it says  ◄── compared ──► what the simulated machine knows
//! ```
//!
//! *Torn before* is a tool that was broken when the drives had come to rest: physics, and no control was there to act. *Torn after*
//! is one that broke from then on, and *false* a statement that is not so: both are defects.
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use test_support::Relay;

/// What drives do that are left alone.
const REACTIONS: [&str; 4] = ["coupled-stop", "quick-stop", "coast", "off"];

/// What is cut: a program, the options that it takes, and from when to when its tool is tied to a spindle, machine time in s.
struct Feature {
    name: &'static str,
    program: &'static str,
    options: &'static [&'static str],
    window: (f64, f64),
}

const TAP: &str = "G21 G90 G54 G17\nT11 M6\nS1000 M3\nG0 X0 Y0\nG43 H11 Z20\nG99 G84 X0 Y0 Z-18 R5 F1250\nG80\nG0 Z50\nM2\n";
const PECK: &str = "G21 G90 G54 G17\nT3 M6\nS3000 M3\nG0 X0 Y0\nG43 H3 Z20\nG99 G84 X0 Y0 Z-12 R5 Q3 F3000\nG80\nG0 Z50\nM2\n";
const SOFT: &str = "G21 G90 G54 G17\nT6 M6\nS2000 M3\nG0 X0 Y0\nG43 H6 Z20\nG99 G84 X0 Y0 Z-6 R5 F1000\nG80\nG0 Z50\nM2\n";

/// A machine that breaks chips instead of going out with each peck.
const CHIP_BREAK: &str = "extends = \"tapping-center\"\nname = \"tapping-center\"\n\n[tapping.peck]\nretract = \"chip-break\"\n";

const FEATURES: [Feature; 10] = [
    Feature { name: "tap M8, S1000", program: TAP, options: &[], window: (1.75, 4.0) },
    Feature { name: "peck tap M6, S3000", program: PECK, options: &[], window: (1.7, 3.4) },
    Feature {
        name: "chip-break peck M6, S3000",
        program: PECK,
        options: &["--machine", "chip-break.toml"],
        window: (1.7, 2.9),
    },
    Feature { name: "soft holder M3, S2000", program: SOFT, options: &[], window: (1.7, 2.5) },
    Feature {
        name: "speed-commanded spindle M8, S1000",
        program: TAP,
        options: &["--machine", "vfd-mill"],
        window: (8.6, 11.0),
    },
    Feature {
        name: "turned thread M20",
        program: include_str!("../../programs/thread-m20x1.5.ngc"),
        options: &["--machine", "lathe"],
        window: (2.8, 5.0),
    },
    Feature {
        name: "hobbing m2 z40",
        program: include_str!("../../programs/gear-m2-z40.nc"),
        options: &["--machine", "gear-hobber"],
        window: (20.0, 40.0),
    },
    Feature {
        name: "polygon AF17",
        program: include_str!("../../programs/hexagon-af17.nc"),
        options: &["--machine", "polygon-lathe"],
        window: (8.0, 13.0),
    },
    Feature {
        name: "cam grinding, 60 rpm",
        program: include_str!("../../programs/cam-shaft.nc"),
        options: &["--machine", "cam-grinder"],
        window: (7.7, 12.9), // cylinder 1: down to size and sparked out
    },
    Feature {
        name: "clutch tap M6, S1000",
        program: "G21 G90 G54 G17\nT13 M6\nS1000 M3\nG0 X0 Y0\nG43 H13 Z20\nG99 G84 X0 Y0 Z-15 R8 F1000\nG80\nG0 Z50\nM2\n",
        options: &[],
        window: (1.7, 3.4),
    },
];

/// What became of the cases of a feature and a reaction.
#[derive(Default)]
struct Row {
    cases: u32,
    recovered: u32,
    to_be_looked_at: u32,
    nothing: u32,
    refused: u32,
    torn_before: u32,
    torn_after: u32,
    not_true: u32,
    /// Largest distance of what was said from the truth over the bound that was said, and the largest bound, µm.
    of_bound: f64,
    bound_um: f64,
    problems: Vec<String>,
}

impl Row {
    fn text(&self, title: &str) -> String {
        format!(
            "| {title} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            self.cases,
            self.recovered,
            self.to_be_looked_at,
            self.nothing,
            self.refused,
            self.torn_before,
            self.torn_after,
            self.not_true,
            if self.bound_um > 0.0 {
                format!("{:.0} % of {:.0} µm", 100.0 * self.of_bound, self.bound_um)
            } else {
                "—".into()
            }
        )
    }

    fn add(&mut self, other: &Self) {
        self.cases += other.cases;
        self.recovered += other.recovered;
        self.to_be_looked_at += other.to_be_looked_at;
        self.nothing += other.nothing;
        self.refused += other.refused;
        self.torn_before += other.torn_before;
        self.torn_after += other.torn_after;
        self.not_true += other.not_true;
        self.of_bound = self.of_bound.max(other.of_bound);
        self.bound_um = self.bound_um.max(other.bound_um);
    }
}

/// Kill in each feature with each reaction at `count` instants; whether nothing was torn afterwards and every statement was true.
pub(crate) fn run(binary: &Path, count: u32, seed: u64) -> bool {
    println!(
        "| what, and what the drives do | cases | recovered | out, to be looked at | nothing to do | refused | torn before anything could act | torn after | false | truth within the bound |\n|---|---|---|---|---|---|---|---|---|---|"
    );
    let mut all = Row::default();
    let mut random = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    for feature in &FEATURES {
        let others = Others::of(binary, feature);
        for reaction in REACTIONS {
            let mut row = Row::default();
            for case in 0..count {
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                let (from, to) = feature.window;
                let share = (f64::from(case) + (random % 1000) as f64 / 1000.0) / f64::from(count);
                let at = from + (to - from) * share;
                row.cases += 1;
                let trial = others.as_ref().map_err(Clone::clone).and_then(|others| {
                    trial((binary, feature, others), reaction, at, case, &mut row)
                });
                if let Err(why) = trial {
                    row.problems.push(format!("{}, {reaction}, {at:.6} s: {why}", feature.name));
                }
            }
            println!("{}", row.text(&format!("{}, {reaction}", feature.name)));
            for problem in &row.problems {
                println!("  {problem}");
            }
            all.add(&row);
            all.problems.append(&mut row.problems);
        }
    }
    println!("{}", all.text("all"));
    all.torn_after == 0 && all.not_true == 0 && all.problems.is_empty()
}

/// A process that ends with its value.
struct Behind(Child);

impl Drop for Behind {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// State folders in which there is a record, and not that of the tool in the work.
struct Others(tempfile::TempDir);

/// All machines are of this epoch; a foreign one has another number.
const EPOCH: [&str; 2] = ["--epoch", "7"];
const FOREIGN: [&str; 2] = ["--serial", "2"];

impl Others {
    /// As complete runs leave them: `old` on this very machine, as if restored from before, and `foreign` on another one.
    fn of(binary: &Path, feature: &Feature) -> Result<Self, String> {
        let kept = tempfile::tempdir().map_err(|e| e.to_string())?;
        for (name, number) in [("old", &[][..]), ("foreign", &FOREIGN)] {
            let trial = Trial::new(binary, feature)?;
            let _simulator = trial.simulator(number)?;
            let ran = trial.run("state").output().map_err(|e| e.to_string())?;
            let record = trial.folder.path().join("state");
            std::fs::rename(&record, kept.path().join(name)).map_err(|e| {
                format!(
                    "no record of {}: {e}: {}",
                    feature.name,
                    String::from_utf8_lossy(&ran.stderr)
                )
            })?;
        }
        Ok(Self(kept))
    }

    /// Beside a trial's own.
    fn copy(&self, to: &Path) -> std::io::Result<()> {
        for name in ["old", "foreign"] {
            std::fs::create_dir(to.join(name))?;
            for file in std::fs::read_dir(self.0.path().join(name))? {
                let file = file?;
                std::fs::copy(file.path(), to.join(name).join(file.file_name()))?;
            }
        }
        Ok(())
    }
}

/// One case, in a folder of its own.
struct Trial<'a> {
    binary: &'a Path,
    folder: tempfile::TempDir,
    feature: &'a Feature,
}

impl<'a> Trial<'a> {
    fn new(binary: &'a Path, feature: &'a Feature) -> Result<Self, String> {
        let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
        for (name, text) in [
            ("part.nc", feature.program),
            ("tools.toml", include_str!("../../programs/tools.toml")),
            ("cams.toml", include_str!("../../programs/cams.toml")),
            ("chip-break.toml", CHIP_BREAK),
        ] {
            std::fs::write(folder.path().join(name), text).map_err(|e| e.to_string())?;
        }
        Ok(Self { binary, folder, feature })
    }

    /// Its machine, listening.
    fn simulator(&self, options: &[&str]) -> Result<Behind, String> {
        let listen = ["simulator", "--listen", "simulator", "--tools", "tools.toml"];
        let listen = [&listen[..], &EPOCH, options, self.feature.options].concat();
        let simulator =
            self.leadscrew(&listen).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut simulator = Behind(simulator.map_err(|e| e.to_string())?);
        let mut line = String::new();
        let said = simulator.0.stdout.take().ok_or("the machine simulator says nothing")?;
        BufReader::new(said).read_line(&mut line).map_err(|e| e.to_string())?;
        Ok(simulator)
    }

    fn leadscrew(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(self.binary);
        command.args(arguments).current_dir(self.folder.path()).stdin(Stdio::null());
        command
    }

    fn output(&self, arguments: &[&str]) -> Result<Output, String> {
        self.leadscrew(arguments).output().map_err(|e| e.to_string())
    }

    fn json(&self, arguments: &[&str]) -> Result<Value, String> {
        let output = self.output(arguments)?;
        serde_json::from_slice(&output.stdout)
            .map_err(|e| format!("{e}: {}", String::from_utf8_lossy(&output.stderr)))
    }

    fn status(&self) -> Result<Value, String> {
        self.json(&["simulator", "--status", "simulator"])
    }

    fn run(&self, state: &str) -> Command {
        let run = [
            "run",
            "part.nc",
            "--simulator",
            "simulator",
            "--state",
            state,
            "--tools",
            "tools.toml",
            "-q",
        ];
        self.leadscrew(&[&run[..], self.feature.options].concat())
    }

    fn recover(&self, state: &str, more: &[&str]) -> Result<Value, String> {
        let machine = self.feature.options;
        let recover = ["recover", "--simulator", "simulator", "--state", state, "--format", "json"];
        self.json(&[&recover[..], machine, more].concat())
    }
}

fn trial(
    (binary, feature, others): (&Path, &Feature, &Others),
    reaction: &str,
    at: f64,
    case: u32,
    row: &mut Row,
) -> Result<(), String> {
    let trial = Trial::new(binary, feature)?;
    others.copy(trial.folder.path()).map_err(|e| e.to_string())?;
    let _simulator = trial.simulator(&["--on-link-loss", reaction])?;
    let relay = Relay::in_place_of(&trial.folder.path().join("simulator"), &[at]);
    let relay = relay.map_err(|e| e.to_string())?;
    let ran = relay.output(&mut trial.run("state")).map_err(|e| e.to_string())?;
    if ran.status.code().is_some() {
        return Err(format!("nothing killed it: {}", String::from_utf8_lossy(&ran.stderr)));
    }
    let before = trial.status()?;
    look(&trial, &before, case)?;
    let answer = trial.recover("state", &[])?;
    let after = trial.status()?;
    judge(&before, &answer, &after, row)
}

/// What only looks changes nothing and denies nothing: a rehearsal, a run that is refused, and both with a state folder that
/// knows nothing, or something else.
fn look(trial: &Trial<'_>, before: &Value, case: u32) -> Result<(), String> {
    let kept = !before["tool_in_work"].is_null();
    match case % 6 {
        1 => {
            trial.recover("state", &["--dry-run"])?;
            trial.recover("state", &["--dry-run"])?;
        }
        2 if kept => refuses_to_run(trial, "state")?,
        0 | 2 => {}
        other => {
            let state = ["missing", "old", "foreign"][other as usize % 3];
            let answer = trial.recover(state, &[])?;
            let denied = answer["outcome"] == "nothing-to-do" && !kept && state == "old";
            if answer["outcome"] != "refused" && !denied {
                return Err(format!("with a state folder that is {state} it says: {answer}"));
            }
            if kept {
                refuses_to_run(trial, state)?;
            }
        }
    }
    let now = trial.status()?;
    for key in ["stop", "tool_in_work", "tool_broken", "tap_in_thread"] {
        if now[key] != before[key] {
            return Err(format!("looking has changed {key} from {} to {}", before[key], now[key]));
        }
    }
    Ok(())
}

fn refuses_to_run(trial: &Trial<'_>, state: &str) -> Result<(), String> {
    match trial.run(state).output().map_err(|e| e.to_string())?.status.code() {
        Some(2) => Ok(()),
        code => Err(format!("a run with a tool in the work, state {state}, ends with {code:?}")),
    }
}

fn judge(before: &Value, answer: &Value, after: &Value, row: &mut Row) -> Result<(), String> {
    let torn = before["tool_broken"] == true;
    row.torn_before += u32::from(torn);
    let mut problems = Vec::new();
    if !torn && after["tool_broken"] == true {
        row.torn_after += 1;
        problems.push("torn by the recovery".to_owned());
    }
    let mut is_false = |why: String| {
        row.not_true += 1;
        problems.push(why);
    };
    match answer["outcome"].as_str() {
        Some("recovered") => {
            row.recovered += u32::from(!torn);
            if torn {
                is_false("a broken tool is said to be out of the work".into());
            } else if after["tap_in_thread"] == true || !after["tool_in_work"].is_null() {
                is_false("a tool that is in the work is said to be out of it".into());
            }
        }
        Some("not-known-whole") => row.to_be_looked_at += u32::from(!torn),
        Some("nothing-to-do") => {
            row.nothing += u32::from(!torn);
            if before["tap_in_thread"] == true {
                is_false("a tap that is in its thread is said not to be".into());
            }
        }
        Some("refused") => row.refused += u32::from(!torn),
        _ => is_false("no answer".into()),
    }
    let numbers = ["phase_error_before_um", "phase_error_bound_um"].map(|key| answer[key].as_f64());
    if let ([Some(said), Some(bound)], Some(truth)) = (numbers, before["off_helix_um"].as_f64()) {
        let off = (said - truth).abs();
        (row.of_bound, row.bound_um) = (row.of_bound.max(off / bound), row.bound_um.max(bound));
        if off > bound {
            is_false(format!("{said:.1} µm are said within {bound:.1}, and it is {truth:.1}"));
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(format!("{}: {answer}", problems.join("; "))) }
}

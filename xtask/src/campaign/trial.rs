//! One case: a feature begun, stopped, looked at, and recovered until nothing stops the recovery
//! any more.
use super::features::{CHIP_BREAK, Feature, tools};
use super::row::Row;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use test_support::{Dice, Relay, Stop};

/// How often a recovery is stopped at most before one is let through.
const STOPPED_AGAIN: usize = 3;

/// A process that ends with its value.
struct Behind(Child);

impl Drop for Behind {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// State folders in which there is a record, and not that of the tool in the work.
pub(super) struct Others(tempfile::TempDir);

/// All machines are of this epoch; a foreign one has another number.
const EPOCH: [&str; 2] = ["--epoch", "7"];
const FOREIGN: [&str; 2] = ["--serial", "2"];

impl Others {
    /// As complete runs leave them: `old` on this very machine, as if restored from before, and
    /// `foreign` on another one.
    pub(super) fn of(binary: &Path, feature: &Feature) -> Result<Self, String> {
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
            ("tools.toml", &tools()),
            ("cams.toml", include_str!("../../../programs/cams.toml")),
            ("chip-break.toml", CHIP_BREAK),
        ] {
            std::fs::write(folder.path().join(name), text).map_err(|e| e.to_string())?;
        }
        Ok(Self { binary, folder, feature })
    }

    /// Its machine, listening.
    fn simulator(&self, options: &[&str]) -> Result<Behind, String> {
        let listen = ["simulator", "--listen", "simulator", "--tools", "tools.toml"];
        let own = [&EPOCH[..], options, self.feature.machine, self.feature.options].concat();
        let listen = [&listen[..], &own].concat();
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

    /// Once, through to its end.
    fn answer(&self, state: &str, more: &[&str]) -> Result<Value, String> {
        self.json(&self.recovery(state, more))
    }

    fn recovery<'o>(&self, state: &'o str, more: &[&'o str]) -> Vec<&'o str>
    where
        'a: 'o,
    {
        let recover = ["recover", "--simulator", "simulator", "--state", state, "--format", "json"];
        [&recover[..], self.feature.options, more].concat()
    }

    /// Recover, and be stopped again at random, until a recovery ends; how the machine was before
    /// that one, and its answer. `stops` takes what stopped the others.
    fn recover(
        &self,
        relay: &Relay,
        dice: &mut Dice,
        stops: &mut Vec<(f64, Stop)>,
    ) -> Result<(Value, Value), String> {
        loop {
            let before = self.status()?;
            let stop = *dice.one_of(&[Stop::Kill, Stop::PowerCut]);
            let planned = stops.len() <= STOPPED_AGAIN && dice.chance(0.5);
            let planned = planned.then(|| {
                let now = before["time_s"].as_f64().unwrap_or_default();
                // a way out takes some periods or some seconds
                (now + dice.between(0.001_f64.ln(), 3_f64.ln()).exp(), stop)
            });
            if let Some((at, stop)) = planned {
                relay.stop_at(at, stop);
            }
            let mut recovery = self.leadscrew(&self.recovery("state", &[]));
            let ended = relay.output(&mut recovery).map_err(|e| e.to_string())?;
            let stopped = planned.filter(|_| relay.cancel_stops());
            let answer = serde_json::from_slice::<Value>(&ended.stdout);
            let outcome = answer.as_ref().ok().and_then(|answer| answer["outcome"].as_str());
            let has_ended = outcome.is_some_and(|outcome| outcome != "refused");
            if let Some(stopped) = stopped.filter(|_| !has_ended) {
                stops.push(stopped);
                continue;
            }
            let said = String::from_utf8_lossy(&ended.stderr);
            return Ok((before, answer.map_err(|e| format!("{e}: {said}"))?));
        }
    }
}

/// Stop `feature` by the first of `stops`, a kill or a power cut, and take its tool out; what
/// stopped recoveries comes to it.
pub(super) fn trial(
    (binary, feature, others): (&Path, &Feature, &Others),
    reaction: &str,
    stops: &mut Vec<(f64, Stop)>,
    dice: &mut Dice,
    row: &mut Row,
) -> Result<(), String> {
    let trial = Trial::new(binary, feature)?;
    others.copy(trial.folder.path()).map_err(|e| e.to_string())?;
    let _simulator = trial.simulator(&["--on-link-loss", reaction, "--on-power-loss", reaction])?;
    let relay = Relay::in_place_of(&trial.folder.path().join("simulator"), &[]);
    let relay = relay.map_err(|e| e.to_string())?;
    for &(at, stop) in stops.iter() {
        relay.stop_at(at, stop);
    }
    let ran = relay.output(&mut trial.run("state")).map_err(|e| e.to_string())?;
    let was_stopped = relay.cancel_stops();
    if !was_stopped {
        return Err(format!("nothing stopped it: {}", String::from_utf8_lossy(&ran.stderr)));
    }
    let stopped = trial.status()?;
    look(&trial, &stopped, dice)?;
    let (before, answer) = trial.recover(&relay, dice, stops)?;
    let after = trial.status()?;
    row.judge(stopped["tool_broken"] == true, [&before, &after], &answer)
}

/// The same stops once more, with nothing looked at between them: what the machine simulator says
/// after each.
pub(super) fn repeat(
    binary: &Path,
    feature: &Feature,
    reaction: &str,
    stops: &[(f64, Stop)],
) -> Result<(), String> {
    let trial = Trial::new(binary, feature)?;
    let _simulator = trial.simulator(&["--on-link-loss", reaction, "--on-power-loss", reaction])?;
    let relay = Relay::in_place_of(&trial.folder.path().join("simulator"), &[]);
    let relay = relay.map_err(|e| e.to_string())?;
    for (begun, &(at, stop)) in stops.iter().enumerate() {
        relay.stop_at(at, stop);
        let mut control = match begun {
            0 => trial.run("state"),
            _ => trial.leadscrew(&trial.recovery("state", &[])),
        };
        let said = relay.output(&mut control).map_err(|e| e.to_string())?;
        let was_stopped = if relay.cancel_stops() { "" } else { ", which did not stop it" };
        println!("{stop:?} at {at:.6} s{was_stopped}");
        println!(
            "{}{}",
            String::from_utf8_lossy(&said.stdout),
            String::from_utf8_lossy(&said.stderr)
        );
        println!("{:#}", trial.status()?);
    }
    println!("then\n{:#}\n{:#}", trial.answer("state", &[])?, trial.status()?);
    Ok(())
}

/// What only looks changes nothing and denies nothing: a rehearsal, a run that is refused, and both
/// with a state folder that knows nothing, or something else.
fn look(trial: &Trial<'_>, before: &Value, dice: &mut Dice) -> Result<(), String> {
    let kept = !before["tool_in_work"].is_null();
    match dice.draw() % 6 {
        1 => {
            trial.answer("state", &["--dry-run"])?;
            trial.answer("state", &["--dry-run"])?;
        }
        2 if kept => refuses_to_run(trial, "state")?,
        0 | 2 => {}
        other => {
            let state = ["missing", "old", "foreign"][other as usize % 3];
            let answer = trial.answer(state, &[])?;
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

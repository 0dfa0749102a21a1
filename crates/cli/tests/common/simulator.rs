//! A simulator as a process of its own, a folder for its state, and programs for it.
use crate::common::{complained, root, said};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use tempfile::TempDir;
use test_support::Relay;

/// What stops a run, and at which machine time, s.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stop {
    Kill(f64),
    PowerCut(f64),
}

/// A running simulator; it ends with the test.
pub(crate) struct Simulator {
    process: Child,
    pub(crate) folder: TempDir,
    relay: Option<Relay>,
}

/// One M8 tap, 20 mm deep at 1000 rpm; `hand` is the cycle.
pub(crate) fn one_tap(hand: &str, tool: u32) -> String {
    let turn = if hand == "G74" { "M4" } else { "M3" };
    format!(
        "G21 G90 G54 G17\nT{tool} M6\nS1000 {turn}\nG0 X0 Y0\nG43 H{tool} Z20\nG99 {hand} X0 Y0 Z-20 R5 F1250\nG80\nG0 Z50\nM2\n"
    )
}

/// The shop's tools, and a left-hand M8.
pub(crate) fn tools() -> String {
    let left = r#"
[[tool]]
number = 41
pocket = 16
kind = "tap"
description = "M8 left hand, rigid collet"
diameter_mm = 8.0
length_mm = 115.0
thread = "M8x1.25-LH"
chamfer_pitches = 2.5
thread_length_mm = 30.0
flute = "spiral-flute"
oversize_um = 45.0
holder = { kind = "rigid", stiffness_n_per_um = 20.0 }
"#;
    std::fs::read_to_string(root().join("programs/tools.toml")).unwrap() + left
}

impl Simulator {
    /// Start one, with these options beside its socket.
    pub(crate) fn start(options: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("tools.toml"), tools()).unwrap();
        let mut process = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
            .args(["simulator", "--listen"])
            .arg(folder.path().join("simulator"))
            .arg("--tools")
            .arg(folder.path().join("tools.toml"))
            .args(options)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(process.stdout.take().unwrap()).read_line(&mut line).unwrap();
        assert!(line.starts_with("listening at"), "{line}");
        Self { process, folder, relay: None }
    }

    /// Start one whose controls are killed (SIGKILL) at these machine times, s, rising.
    pub(crate) fn killing_at(kills: &[f64], options: &[&str]) -> Self {
        let mut simulator = Self::start(options);
        let relay = Relay::in_place_of(&simulator.path("simulator"), kills).unwrap();
        simulator.relay = Some(relay);
        simulator
    }

    /// Start one that is stopped so.
    pub(crate) fn stopping(stop: Stop, options: &[&str]) -> Self {
        match stop {
            Stop::Kill(at) => Self::killing_at(&[at], options),
            Stop::PowerCut(at) => {
                let at = at.to_string();
                Self::start(&[&["--power-cut-at", &at], options].concat())
            }
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn leadscrew(arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_leadscrew"));
        command.args(arguments).env("NO_COLOR", "1");
        command
    }

    /// A control at this simulator.
    fn control(&self, arguments: &[&str]) -> Output {
        let mut command = Self::leadscrew(arguments);
        match &self.relay {
            Some(relay) => relay.output(&mut command).unwrap(),
            None => command.output().unwrap(),
        }
    }

    /// Run a program on it, with further options.
    pub(crate) fn run(&self, program: &str, options: &[&str]) -> Output {
        let file = self.path("part.ngc");
        std::fs::write(&file, program).unwrap();
        let (simulator, state, tools) =
            (self.path("simulator"), self.path("state"), self.path("tools.toml"));
        let mut arguments = vec![
            "run",
            file.to_str().unwrap(),
            "--simulator",
            simulator.to_str().unwrap(),
            "--state",
            state.to_str().unwrap(),
            "--tools",
            tools.to_str().unwrap(),
            "-q",
            "--format",
            "json",
        ];
        arguments.extend(options);
        self.control(&arguments)
    }

    /// Recover; the answer.
    pub(crate) fn recover(&self, options: &[&str]) -> Value {
        let (simulator, state) = (self.path("simulator"), self.path("state"));
        let mut arguments = vec![
            "recover",
            "--simulator",
            simulator.to_str().unwrap(),
            "--state",
            state.to_str().unwrap(),
            "--format",
            "json",
        ];
        arguments.extend(options);
        let output = self.control(&arguments);
        serde_json::from_slice(&output.stdout)
            .unwrap_or_else(|e| panic!("{e}: {}{}", said(&output), complained(&output)))
    }

    /// The next control is killed so long after now, s of machine time.
    pub(crate) fn kill_after(&self, seconds: f64) {
        let now = self.status()["time_s"].as_f64().unwrap();
        self.relay.as_ref().unwrap().stop_at(now + seconds, test_support::Stop::Kill);
    }

    /// Recover, and be killed at it.
    pub(crate) fn recover_killed(&self) -> bool {
        let (simulator, state) = (self.path("simulator"), self.path("state"));
        let [simulator, state] = [&simulator, &state].map(|path| path.to_str().unwrap());
        self.control(&["recover", "--simulator", simulator, "--state", state])
            .status
            .code()
            .is_none()
    }

    /// How it is.
    pub(crate) fn status(&self) -> Value {
        let socket = self.path("simulator");
        let output =
            Self::leadscrew(&["simulator", "--status", socket.to_str().unwrap()]).output().unwrap();
        serde_json::from_slice(&output.stdout).unwrap()
    }

    /// Where its state is kept.
    pub(crate) fn state(&self) -> PathBuf {
        self.path("state")
    }
}

impl Drop for Simulator {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A number of an answer.
#[track_caller]
pub(crate) fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("no number {key} in {value:#}"))
}

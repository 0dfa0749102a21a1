//! Lock-step and real time, with the machine in the process and in another one: in each of the four
//! a part is cut, a feed is held, a run is stopped, a control is killed and its tap recovered. On
//! HAL, which has a servo thread of its own, `tools/hal --smoke` does the same.
//!
//! ```text
//!             in the process            in another process
//!   lock-step  part · holds · stops      part · holds · stops · kill ─► recover
//!   real time  part · holds · stops      part · holds · stops · kill ─► recover
//! ```
use crate::common::{complained, leadscrew, said};
use crate::simulator::{Simulator, number, one_tap, tools};
use serde_json::Value;
use std::process::Output;

/// Two holes, drilled and tapped.
const PART: &str = "\
G21 G90 G54 G17
T2 M6
S6000 M3
G43 H2 G0 Z20
G99 G81 X0 Y0 Z-18 R2 F900
X20
G80 G0 Z50
T3 M6
S1000 M3
G43 H3 G0 Z20
G99 G84 X0 Y0 Z-12 R5 F1000
X20
G80
G0 Z50
M2
";

/// How it is run: by the clock or not, and where its machine is.
#[derive(Clone, Copy, Debug)]
struct Cell {
    by_the_clock: bool,
    beside: bool,
}

/// All four, each by one activity; by the clock they mostly wait.
fn in_each(activity: impl Fn(Cell) + Sync) {
    std::thread::scope(|scope| {
        for by_the_clock in [false, true] {
            for beside in [false, true] {
                let activity = &activity;
                scope.spawn(move || activity(Cell { by_the_clock, beside }));
            }
        }
    });
}

impl Cell {
    fn options(self, operator: &str) -> Vec<&str> {
        let mut options = if self.by_the_clock { vec!["--real-time"] } else { vec![] };
        if !operator.is_empty() {
            options.extend(["--operator", operator]);
        }
        options
    }

    /// What becomes of a program with these orders, and whether a tool is in the work afterwards,
    /// where the machine lives to be asked.
    fn run(self, program: &str, operator: &str) -> (Output, Option<bool>) {
        if self.beside {
            let simulator = Simulator::start(&[]);
            let output = simulator.run(program, &self.options(operator));
            let status = simulator.status();
            assert_eq!(status["tool_broken"], false, "{self:?} {operator}: {status:#}");
            return (output, Some(status["tap_in_thread"] == true));
        }
        let folder = tempfile::tempdir().unwrap();
        let [file, table] = ["part.ngc", "tools.toml"].map(|name| folder.path().join(name));
        std::fs::write(&file, program).unwrap();
        std::fs::write(&table, tools()).unwrap();
        let (file, table) = (file.to_str().unwrap(), table.to_str().unwrap());
        let words = ["run", file, "--tools", table, "-q", "--format", "json"];
        (leadscrew(&[&words, self.options(operator).as_slice()].concat()), None)
    }

    /// The certificate of a run that ended with this exit code.
    fn certificate(self, output: &Output, code: i32) -> Value {
        let words = said(output) + &complained(output);
        assert_eq!(output.status.code(), Some(code), "{self:?}: {words}");
        serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{self:?}: {e}: {words}"))
    }
}

#[test]
fn a_part_is_cut_alike_by_the_clock_and_in_lock_step_here_and_beside() {
    in_each(|cell| {
        let certificate = cell.certificate(&cell.run(PART, "").0, 0);
        let features = certificate["features"].as_array().unwrap();
        let good = features.iter().filter(|feature| feature["verdict"] == "pass").count();
        assert!(certificate["ended"] == true && good == 4, "{cell:?}: {certificate:#}");
    });
}

#[test]
fn a_feed_that_is_held_in_a_thread_is_gone_on_with_or_left_or_stopped() {
    in_each(|cell| {
        for (orders, code) in [
            ("hold at depth 8mm; resume at 4s", 0),
            ("hold at depth 8mm; retract at 4s", 3),
            ("abort at depth 8mm", 3),
        ] {
            let (output, inside) = cell.run(&one_tap("G84", 11), orders);
            let certificate = cell.certificate(&output, code);
            assert_eq!(certificate["ended"], code == 0, "{cell:?} {orders}: {certificate:#}");
            // an abort leaves the tap engaged, for a retract or a recovery
            let stays = orders.starts_with("abort");
            assert_eq!(inside.unwrap_or(stays), stays, "{cell:?} {orders}: {certificate:#}");
        }
    });
}

#[test]
fn a_control_that_is_killed_in_a_thread_is_recovered_by_the_clock_and_in_lock_step() {
    for by_the_clock in [false, true] {
        let cell = Cell { by_the_clock, beside: true };
        let simulator = Simulator::killing_at(&[2.9], &[]);
        let output = simulator.run(&one_tap("G84", 11), &cell.options(""));
        assert_eq!(output.status.code(), None, "{cell:?}: {}", complained(&output));
        assert_eq!(simulator.status()["tap_in_thread"], true, "{cell:?}");
        let answer = simulator.recover(&[]);
        let after = simulator.status();
        assert_eq!(answer["outcome"], "recovered", "{cell:?}: {answer:#}");
        assert!(number(&answer, "helix_error_max_um") <= 20.0, "{cell:?}: {answer:#}");
        let free = after["tool_broken"] == false && after["tap_in_thread"] == false;
        assert!(free, "{cell:?}: {after:#}");
        let again = simulator.run(&one_tap("G84", 11), &cell.options(""));
        cell.certificate(&again, 0);
    }
}

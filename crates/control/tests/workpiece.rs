//! A workpiece begins and ends; what is cut is counted for it, kept as it is cut, and bounded in
//! memory.
use control::job::{ProgramOptions, restart};
use control::operation::{Execution, FeatureCount, Request};
use control::{Control, ControlOptions};
use std::fs;
use std::path::{Path, PathBuf};
use store::state::{MachineIdentity, StateFolder};

/// A hole, and a hole that is tapped.
const PROGRAM: &str = "G21 G90 G54 G17 G94\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z5\n\
    G99 G81 X0 Y0 Z-16 R2 F600\nG81 X20 Y0 Z-16 R2\nG80\nG0 Z50\n\
    T3 M6\nG43 H3\nS1500 M3\nG99 G84 X0 Y0 Z-10 R5 F1500\nG84 X20 Y0 Z-10 R5\nG80\nG0 Z50\nM2\n";

/// A control of this machine with a state folder, switched on and homed.
pub(crate) fn control(machine: &str, state: &Path) -> Control {
    let options = ControlOptions {
        state: Some(state.to_owned()),
        ..ControlOptions::simulated(ProgramOptions::from(machine))
    };
    let mut control = Control::new(options).map_err(|why| why.to_string()).unwrap();
    make_ready(&mut control);
    control
}

/// Switches a control on and homes it.
pub(crate) fn make_ready(control: &mut Control) {
    control.request(&Request::Power(true)).unwrap();
    until(control, Control::is_ready);
    control.request(&Request::Home(None)).unwrap();
    until(control, |control| control.is_homed_all() && control.is_at_standstill());
}

pub(crate) fn until(control: &mut Control, is_so: impl Fn(&Control) -> bool) {
    for _ in 0..2_000_000 {
        if is_so(control) {
            return;
        }
        control.period();
    }
    panic!("{:?}", control.status());
}

fn program(home: &Path) -> PathBuf {
    let path = home.join("part.ngc");
    fs::write(&path, PROGRAM).unwrap();
    path
}

fn run(control: &mut Control) {
    control.request(&Request::Start).unwrap();
    until(control, |control| control.execution() == Execution::ProgramCompleted);
    // the last feature is judged when its tool is out
    (0..10).for_each(|_| control.period());
}

fn all(count: FeatureCount) -> usize {
    count.good + count.failed + count.not_judged
}

#[test]
fn a_workpiece_begins_and_ends_by_a_request_and_counts_say_of_what() {
    let home = tempfile::tempdir().unwrap();
    let state = home.path().join("state");
    let mut first = control("tapping-center", &state);
    first.request(&Request::Load(program(home.path()))).unwrap();
    run(&mut first);
    run(&mut first);
    let status = first.status();
    assert_eq!((all(status.features), status.workpiece.number), (8, 1));
    assert_eq!((status.workpiece.programs, first.features().len()), (2, 8));
    first.request(&Request::BeginWorkpiece(Some("housing 17".into()))).unwrap();
    let status = first.status();
    assert_eq!((all(status.features), first.features().len()), (0, 0));
    assert_eq!(status.workpiece.name.as_deref(), Some("housing 17"));
    run(&mut first);
    let count = first.status().features;
    assert_eq!((count.good, count.failed), (4, 0), "it is cut into new stock: {count:?}");
    drop(first);
    // a control that is started again goes on with it
    let mut second = control("tapping-center", &state);
    let status = second.status();
    assert_eq!((status.workpiece.number, all(status.features)), (2, 4));
    assert_eq!((status.workpiece.unlisted, second.features().len()), (4, 0));
    second.request(&Request::EndWorkpiece).unwrap();
    assert!(second.status().workpiece.is_ended);
    assert!(second.request(&Request::EndWorkpiece).is_err());
    second.request(&Request::Load(program(home.path()))).unwrap();
    run(&mut second);
    let status = second.status();
    assert_eq!((status.workpiece.number, all(status.features)), (3, 4));
    let log = fs::read_to_string(state.join("features.jsonl")).unwrap();
    assert_eq!(log.lines().count(), 16, "all of them are on the disk");
}

#[test]
fn where_the_machines_file_says_so_each_start_from_the_beginning_is_another_workpiece() {
    let home = tempfile::tempdir().unwrap();
    let machine = home.path().join("line.toml");
    let text = "name = \"line\"\nextends = \"tapping-center\"\n[control]\nworkpiece_begins = \"at-start\"\n";
    fs::write(&machine, text).unwrap();
    let mut control = control(&machine.display().to_string(), &home.path().join("state"));
    control.request(&Request::Load(program(home.path()))).unwrap();
    run(&mut control);
    run(&mut control);
    let status = control.status();
    assert_eq!((status.workpiece.number, all(status.features)), (2, 4));
    // one that begins in its middle goes on with the same
    control.request(&Request::Search(restart::From::Hole(4), false)).unwrap();
    run(&mut control);
    let status = control.status();
    assert_eq!((status.workpiece.number, status.workpiece.programs), (2, 2));
    assert_eq!(all(status.features), 5);
}

#[test]
fn what_was_cut_before_a_kill_is_in_the_lives_of_the_tools_the_workpiece_and_the_program() {
    let home = tempfile::tempdir().unwrap();
    let state = home.path().join("state");
    let mut control = control("tapping-center", &state);
    control.request(&Request::Load(program(home.path()))).unwrap();
    control.request(&Request::Start).unwrap();
    until(&mut control, |control| all(control.status().features) == 3);
    // as a control leaves it that is killed now
    let killed = home.path().join("killed");
    fs::create_dir(&killed).unwrap();
    for entry in fs::read_dir(&state).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), killed.join(entry.file_name())).unwrap();
    }
    let machine = MachineIdentity::of(control.machine());
    let (_, kept, found) = StateFolder::open(&killed, &machine).unwrap();
    assert_eq!((found, kept.changes), (Vec::new(), Vec::new()));
    let uses = |tool| kept.tools.as_ref().unwrap().get(tool).unwrap().life.used.uses;
    assert_eq!(uses(2), 2);
    assert!((1..=2).contains(&uses(3)), "{}", uses(3));
    let cut = kept.workpiece.unwrap();
    assert_eq!((cut.programs, cut.good + cut.failed + cut.not_judged), (1, 3));
    assert_eq!(kept.last_program.map(|last| last.feature), Some(3));
}

#[test]
fn a_program_that_was_changed_since_it_was_left_is_not_begun_in_its_middle_without_a_word() {
    let home = tempfile::tempdir().unwrap();
    let state = home.path().join("state");
    let mut first = control("tapping-center", &state);
    let path = program(home.path());
    first.request(&Request::Load(path.clone())).unwrap();
    first.request(&Request::Start).unwrap();
    until(&mut first, |control| all(control.status().features) == 1);
    drop(first);
    fs::write(&path, PROGRAM.replace("X20 Y0 Z-16", "X30 Y0 Z-16")).unwrap();
    let mut second = control("tapping-center", &state);
    let accepted = second.request(&Request::Load(path.clone())).unwrap();
    let is_said = |note: &String| note.contains("was changed since it was left");
    assert!(accepted.notes.iter().any(is_said), "{accepted:?}");
    let hole = restart::From::Hole(2);
    let refused = second.request(&Request::Search(hole, false)).unwrap_err().to_string();
    assert!(refused.contains("in feature 1") && refused.contains("program_changed"), "{refused}");
    second.request(&Request::Search(hole, true)).unwrap();
    // the text that was left is begun without a question
    fs::write(&path, PROGRAM).unwrap();
    second.request(&Request::Load(path)).unwrap();
    second.request(&Request::Search(hole, false)).unwrap();
}

/// A program that calls two files, of which one calls the other, and is left after its first
/// feature; the control that comes after it.
struct LeftHalfDone {
    home: tempfile::TempDir,
    control: Control,
}

const CALLS: &str = "G21 G90 G54 G17 G94\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z5\n\
    o<holes> call\nG80\nG0 Z50\nM2\n";
const HOLES: &str = "o<holes> sub\nG99 G81 X0 Y0 Z-16 R2 F600\no<more> call\no<holes> endsub\n";
const MORE: &str = "o<more> sub\nG81 X20 Y0 Z-16 R2\nG81 X40 Y0 Z-16 R2\no<more> endsub\n";

impl LeftHalfDone {
    fn new() -> Self {
        let home = tempfile::tempdir().unwrap();
        let left = Self { control: control("tapping-center", &home.path().join("state")), home };
        left.write("calls.ngc", CALLS);
        left.write("holes.ngc", HOLES);
        left.write("more.ngc", MORE);
        left.write("other.ngc", PROGRAM);
        let mut left = left;
        left.load("calls.ngc");
        left.control.request(&Request::Start).unwrap();
        until(&mut left.control, |control| all(control.status().features) == 1);
        left.switched_off_and_on()
    }

    fn switched_off_and_on(self) -> Self {
        let Self { home, control: before } = self;
        drop(before);
        Self { control: control("tapping-center", &home.path().join("state")), home }
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.home.path().join(name), text).unwrap();
    }

    fn load(&mut self, name: &str) {
        self.control.request(&Request::Load(self.home.path().join(name))).unwrap();
    }

    /// Where the second hole is, or why not.
    fn search(&mut self) -> Result<(), String> {
        let found = self.control.request(&Request::Search(restart::From::Hole(2), false));
        found.map(drop).map_err(|why| why.to_string())
    }
}

#[test]
fn an_edit_of_any_file_that_a_program_calls_is_one_of_the_program() {
    let mut left = LeftHalfDone::new();
    for (file, text) in [("calls.ngc", CALLS), ("holes.ngc", HOLES), ("more.ngc", MORE)] {
        let edited = text.replace("Z-16", "Z-18").replace("S3000", "S2500");
        assert_ne!(edited, text);
        left.write(file, &edited);
        left.load("calls.ngc");
        let refused = left.search().expect_err(file);
        assert!(refused.contains("or a file that it calls was changed since"), "{refused}");
        left.write(file, text);
        left.load("calls.ngc");
        left.search().expect(file);
    }
    // confirmed, it is begun; then it is the program that was left
    left.write("more.ngc", &MORE.replace("X40", "X45"));
    left.load("calls.ngc");
    left.control.request(&Request::Search(restart::From::Hole(2), true)).unwrap();
    let before = all(left.control.status().features);
    left.control.request(&Request::Start).unwrap();
    until(&mut left.control, |control| all(control.status().features) == before + 1);
    let mut left = left.switched_off_and_on();
    left.load("calls.ngc");
    left.search().unwrap();
}

#[test]
fn only_a_start_takes_the_place_of_how_far_a_program_came() {
    let mut left = LeftHalfDone::new();
    left.load("calls.ngc");
    left.load("other.ngc");
    left.search().unwrap();
    let mut left = left.switched_off_and_on();
    left.write("more.ngc", &MORE.replace("X40", "X45"));
    left.load("other.ngc");
    left.load("calls.ngc");
    left.search().unwrap_err();
    fs::create_dir(left.home.path().join("elsewhere")).unwrap();
    left.load("./elsewhere/../calls.ngc");
    left.search().unwrap_err();
    // the same texts and others under another name, and others of the same name elsewhere
    left.write("copy.ngc", CALLS);
    left.load("copy.ngc");
    left.search().unwrap();
    left.write("elsewhere/calls.ngc", PROGRAM);
    left.load("elsewhere/calls.ngc");
    left.search().unwrap();
    left.load("calls.ngc");
    left.search().unwrap_err();
    run(&mut left.control);
    left.write("more.ngc", MORE);
    left.load("calls.ngc");
    left.search().unwrap();
}

#[test]
fn a_called_file_that_is_edited_after_the_search_starts_nothing_and_the_place_is_kept() {
    let mut left = LeftHalfDone::new();
    left.load("calls.ngc");
    left.search().unwrap();
    left.write("more.ngc", &MORE.replace("X40", "X45"));
    for _ in 0..2 {
        let refused = left.control.request(&Request::Start).unwrap_err().to_string();
        assert!(refused.contains("search again"), "{refused}");
    }
    left.write("more.ngc", MORE);
    let before = all(left.control.status().features);
    run(&mut left.control);
    assert_eq!(all(left.control.status().features), before + 2);
}

/// A pipe that no program reads would keep the one thread that writes.
#[test]
#[cfg(unix)]
fn logs_that_are_named_pipes_are_said_and_all_else_is_kept() {
    let home = tempfile::tempdir().unwrap();
    let state = home.path().join("state");
    let mut control = control("tapping-center", &state);
    let path = home.path().join("part.ngc");
    fs::write(&path, PROGRAM.replacen("T2 M6\n", "(MSG, clamp it)\nT2 M6\n", 1)).unwrap();
    for name in ["messages.jsonl", "features.jsonl"] {
        let made = std::process::Command::new("mkfifo").arg(state.join(name)).status();
        assert!(made.unwrap().success());
    }
    control.request(&Request::Load(path)).unwrap();
    run(&mut control);
    let mut said = Vec::new();
    while let Some(event) = control.next_event() {
        said.push(format!("{event:?}"));
    }
    for words in [
        "a message is not kept: messages.jsonl: it is a named pipe",
        "a feature is not in the log: features.jsonl: it is a named pipe",
    ] {
        assert!(said.iter().any(|text| text.contains(words)), "{words}: {said:#?}");
    }
    let machine = MachineIdentity::of(control.machine());
    drop(control);
    let (_, kept, found) = StateFolder::open(&state, &machine).unwrap();
    assert_eq!((found, kept.changes), (Vec::new(), Vec::new()));
    assert!(kept.last_program.unwrap().is_completed);
}

#[test]
fn however_many_programs_are_run_the_features_in_memory_are_bounded() {
    let home = tempfile::tempdir().unwrap();
    let mut control = control("tapping-center", &home.path().join("state"));
    control.request(&Request::Load(program(home.path()))).unwrap();
    let runs = test_support::size::of(3, 200);
    for _ in 0..runs {
        run(&mut control);
    }
    let status = control.status();
    assert_eq!(all(status.features), runs as usize * 4);
    assert!(control.features().len() <= control::operation::MOST_SHOWN + 4);
    assert_eq!(control.features().len() + status.workpiece.unlisted, runs as usize * 4);
}

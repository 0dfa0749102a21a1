//! A long program is interpreted and planned in another thread while the control goes on.
use canon::Axis;
use control::job::{Interruption, ProgramOptions};
use control::operation::{Begun, Execution, Proving, Request, ToolField};
use control::{Control, ControlOptions};
use units::Coordinate;

const TEXT: &str = "G21 G90 G54 G94\nG1 F600 X1\nX0\nM2\n";

fn homed() -> Control {
    let options = ControlOptions {
        seed: Some(1),
        ..ControlOptions::simulated(ProgramOptions::on("bench-xyz"))
    };
    let mut control = Control::new(options).unwrap();
    control.request(&Request::Power(true)).unwrap();
    while !control.status().is_ready {
        control.period();
    }
    control.request(&Request::Home(None)).unwrap();
    for _ in 0..10 {
        control.period();
    }
    control
}

fn proving(control: &mut Control, request: &Request) -> Box<Proving> {
    match control.begin(request) {
        Begun::Proving(proving) => proving,
        Begun::Answered(answer) => panic!("{answer:?}"),
    }
}

#[test]
fn a_program_is_read_in_another_thread_loaded_and_started_while_periods_pass() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.ngc");
    std::fs::write(&path, TEXT).unwrap();
    let mut control = homed();
    for (request, x) in [(Request::Load(path), 1.0), (Request::Start, 2.0)] {
        control.request(&Request::TouchOff(Axis::X, Coordinate::new(x))).unwrap();
        let proving = proving(&mut control, &request);
        let thread = std::thread::scope(|scope| {
            let thread = scope.spawn(|| proving.prove());
            control.period(); // it goes on meanwhile
            thread.join().unwrap()
        });
        control.complete(thread).unwrap();
    }
    assert!(control.execution().is_under_way());
    for _ in 0..20_000 {
        control.period();
    }
    assert_eq!(control.execution(), Execution::ProgramCompleted);
}

/// Loaded in the control.
fn loaded(control: &mut Control, text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.ngc");
    std::fs::write(&path, text).unwrap();
    control.request(&Request::Load(path)).unwrap();
    folder
}

fn is_answered(control: &mut Control, request: &Request) -> bool {
    matches!(control.begin(request), Begun::Answered(Ok(_)))
}

#[test]
fn what_is_loaded_is_started_without_being_proved_again_where_nothing_has_changed() {
    let mut control = homed();
    let _folder = loaded(&mut control, TEXT);
    assert!(control.renewal().is_none());
    assert!(is_answered(&mut control, &Request::Start));
    for _ in 0..20_000 {
        control.period();
    }
    assert_eq!(control.execution(), Execution::ProgramCompleted);
    // the program has left its own modes in force
    let renewal = control.renewal().expect("it stands elsewhere than before");
    control.renew(renewal.prove());
    assert!(control.renewal().is_none());
    assert!(is_answered(&mut control, &Request::Start));
}

#[test]
fn offsets_tools_and_skipped_blocks_that_change_are_proved_again() {
    let mut control = homed();
    let _folder = loaded(&mut control, TEXT);
    for change in [
        Request::TouchOff(Axis::X, Coordinate::new(3.0)),
        Request::EditTool(1, ToolField::WearLength, 0.1),
        Request::BlockSkip(2, true),
        Request::ManualDataInput("G1 F600 X2".into()),
    ] {
        control.request(&change).unwrap_or_else(|why| panic!("{change:?}: {why}"));
        while control.execution().is_under_way() {
            control.period();
        }
        let renewal = control.renewal().unwrap_or_else(|| panic!("{change:?}"));
        assert!(!is_answered(&mut control, &Request::Start), "{change:?}");
        control.renew(renewal.prove());
        assert!(control.renewal().is_none(), "{change:?}");
    }
    assert!(is_answered(&mut control, &Request::Start));
}

#[test]
fn a_renewal_that_is_refused_is_not_repeated_and_is_said_at_the_start() {
    let mut control = homed();
    let _folder = loaded(&mut control, "G21 G90 G54 G94\nG1 F600 X290\nX0\nM2\n");
    control.request(&Request::TouchOff(Axis::X, Coordinate::new(-5e3))).unwrap();
    let renewal = control.renewal().expect("the offset has changed");
    control.renew(renewal.prove());
    assert!(control.renewal().is_none());
    let refused = control.request(&Request::Start).unwrap_err().to_string();
    assert!(refused.contains("travel"), "{refused}");
}

#[test]
fn nothing_is_renewed_where_the_program_could_not_be_started() {
    let mut control = homed();
    let _folder = loaded(&mut control, TEXT);
    control.request(&Request::TouchOff(Axis::X, Coordinate::new(3.0))).unwrap();
    assert!(control.renewal().is_some());
    control.request(&Request::Power(false)).unwrap();
    control.period();
    assert!(control.renewal().is_none(), "the drives are off");
}

#[test]
fn of_two_programs_that_are_loaded_one_after_the_other_the_last_is_started() {
    let mut control = homed();
    let first = loaded(&mut control, TEXT);
    control.request(&Request::TouchOff(Axis::X, Coordinate::new(3.0))).unwrap();
    let renewal = control.renewal().expect("the offset has changed");
    let _second = loaded(&mut control, "G21 G90 G54 G94\nG1 F600 X2\nM2\n");
    control.renew(renewal.prove());
    drop(first);
    assert!(is_answered(&mut control, &Request::Start));
    assert!(control.status().program.unwrap().name.ends_with("part.ngc"));
    assert_eq!(control.status().program.unwrap().line, 0);
}

#[test]
fn what_was_proved_for_other_offsets_than_those_in_force_is_not_executed() {
    let mut control = homed();
    let typed = Request::ManualDataInput("G1 F600 X1".into());
    let proving = proving(&mut control, &typed);
    control.request(&Request::TouchOff(Axis::X, Coordinate::new(3.0))).unwrap();
    let refused = control.complete(proving.prove()).unwrap_err().to_string();
    assert_eq!(refused, "offsets, tools or positions have changed while it was read: ask again");
    assert!(!control.execution().is_under_way());
}

#[test]
fn what_needs_no_proof_is_answered_at_once() {
    let mut control = homed();
    assert!(matches!(control.begin(&Request::FeedOverride(0.5)), Begun::Answered(Ok(_))));
    assert!(matches!(control.begin(&Request::Resume), Begun::Answered(Err(_))));
    assert!(matches!(control.begin(&Request::Start), Begun::Answered(Err(_))));
}

/// More lines than are planned while people wait; each takes a tenth of a second at F600.
fn long(lines: usize) -> String {
    let moves = "X1\nX0\n".repeat(lines / 2);
    format!("G21 G90 G54 G94 G61\nG1 F600\n{moves}M2\n")
}

/// Loaded as a control that stays on does it.
fn loaded_apart(control: &mut Control, text: &str) -> (Vec<String>, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.ngc");
    std::fs::write(&path, text).unwrap();
    let proven = proving(control, &Request::Load(path)).prove();
    (control.complete(proven).unwrap().notes, folder)
}

/// Planned, and left.
fn times(control: &Control) -> (Option<f64>, Option<f64>) {
    let program = control.status().program.unwrap();
    (program.planned_s, program.left_s)
}

#[test]
fn a_long_program_is_started_before_its_time_is_known() {
    let mut control = homed();
    let (notes, _folder) = loaded_apart(&mut control, &long(1200));
    assert!(notes[0].ends_with("operations, its time is being planned"), "{notes:?}");
    assert_eq!(times(&control), (None, None));
    let timing = control.timing().expect("its time is not known");
    assert!(is_answered(&mut control, &Request::Start));
    for _ in 0..3000 {
        control.period();
    }
    assert_eq!(times(&control), (None, None));
    assert!(control.untimed().is_some(), "a program that is under way is timed too");
    control.timed(timing.plan());
    assert!(control.untimed().is_none());
    let (Some(planned), Some(left)) = times(&control) else { panic!("{:?}", control.status()) };
    // each line at 10 mm/s, with a ramp up and down
    assert!((120.0..140.0).contains(&planned), "{planned} s");
    let elapsed = control.status().program.unwrap().elapsed_s;
    assert!((planned - left - elapsed).abs() < 0.2, "{left} s of {planned} s");
}

#[test]
fn a_long_program_that_is_refused_is_refused_when_it_is_loaded() {
    let mut control = homed();
    let text = long(1200).replace("M2", "G1 X9999\nM2");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.ngc");
    std::fs::write(&path, text).unwrap();
    let proven = proving(&mut control, &Request::Load(path)).prove();
    let refused = control.complete(proven).unwrap_err().to_string();
    assert!(refused.contains("travel"), "{refused}");
    assert!(control.untimed().is_none());
}

#[test]
fn the_time_of_a_program_is_its_own() {
    let mut control = homed();
    let (_, first) = loaded_apart(&mut control, &long(1200));
    let timing = control.timing().expect("its time is not known");
    let broken_off = control.timing().expect("as before").unless(Interruption::by(|| true));
    control.timed(broken_off.plan());
    assert_eq!(times(&control), (None, None));
    let (_, _second) = loaded_apart(&mut control, &long(2400));
    drop(first);
    control.timed(timing.plan());
    assert_eq!(times(&control), (None, None), "that was the time of another one");
    let timing = control.timing().expect("its time is not known");
    control.timed(timing.plan());
    let (planned, left) = times(&control);
    assert!(planned.is_some_and(|planned| planned > 240.0), "{planned:?}");
    assert_eq!(planned, left);
}

#[test]
fn the_time_of_a_short_program_is_known_at_once() {
    let mut control = homed();
    let (notes, _folder) = loaded_apart(&mut control, &long(100));
    assert!(notes[0].contains("planned 1"), "{notes:?}");
    assert!(control.untimed().is_none() && control.timing().is_none());
}

#[test]
fn the_time_of_what_is_typed_is_not_that_of_the_program_that_is_loaded() {
    let mut control = homed();
    let (_, _folder) = loaded_apart(&mut control, &long(100));
    let (planned, _) = times(&control);
    let typed = "X1\nX0\n".repeat(600);
    let typed = Request::ManualDataInput(format!("G90 G1 F6000\n{typed}"));
    let proven = proving(&mut control, &typed).prove();
    control.complete(proven).unwrap();
    let timing = control.timing().expect("it is long");
    control.timed(timing.plan());
    while control.execution().is_under_way() {
        control.period();
    }
    assert_eq!(times(&control).0, planned);
}

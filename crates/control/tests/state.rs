//! A state that is not what the control wrote last: named value by value, and nothing is started on
//! it until it is acknowledged.
use canon::Axis;
use control::job::ProgramOptions;
use control::operation::{Event, Jog, Need, Refusal, Request};
use control::{Control, ControlOptions};
use std::fs;
use std::path::Path;
use units::Coordinate;

fn switched_on(machine: &str, state: &Path) -> Result<Control, String> {
    let options = ControlOptions {
        state: Some(state.to_owned()),
        ..ControlOptions::simulated(ProgramOptions::from(machine))
    };
    Control::new(options).map_err(|refused| refused.to_string())
}

fn control(state: &Path) -> Control {
    switched_on("tapping-center", state).unwrap()
}

fn set(control: &mut Control, x: f64) {
    let g54 = Request::SetWorkOffset(1, Axis::X, Coordinate::new(x));
    control.request(&g54).unwrap();
}

fn powered(control: &mut Control) {
    control.request(&Request::Power(true)).unwrap();
    for _ in 0..20_000 {
        if control.is_ready() {
            return;
        }
        control.period();
    }
    panic!("the drives do not come up");
}

fn g54_x(control: &Control) -> f64 {
    control.zero_of(1, Axis::X).value()
}

/// A folder in which G54 X was -240 and then -250, and in which a person has written -245.
fn edited() -> tempfile::TempDir {
    let home = tempfile::tempdir().unwrap();
    let mut first = control(home.path());
    set(&mut first, -240.0);
    set(&mut first, -250.0);
    drop(first);
    let file = home.path().join("parameters.var");
    let text = fs::read_to_string(&file).unwrap();
    let (_, body) = text.split_once('\n').unwrap();
    let body = body.replace("-250.000000", "-245.000000");
    fs::write(&file, format!("# leadscrew parameters 1, edited\n{body}")).unwrap();
    home
}

#[test]
fn nothing_is_started_on_a_state_that_the_control_has_not_written_until_it_is_acknowledged() {
    let home = edited();
    let mut control = control(home.path());
    assert_eq!(g54_x(&control), -245.0);
    let changes = control.status().state_changes;
    let [change] = changes.as_slice() else { panic!("{changes:?}") };
    assert_eq!(
        (change.datum.as_str(), change.before.as_str(), change.now.as_str()),
        ("G54 X", "-250.000", "-245.000")
    );
    let alarm = control.alarms().last().unwrap();
    assert_eq!((alarm.number, alarm.is_cleared), (601, false));
    assert!(alarm.text.contains("G54 X -250.000 → -245.000"), "{}", alarm.text);
    powered(&mut control);
    let program = home.path().join("part.ngc");
    fs::write(&program, "G21 G90 G54\nG0 X1\nM2\n").unwrap();
    control.request(&Request::Load(program)).unwrap();
    for request in [
        Request::Start,
        Request::ManualDataInput("G0 X1".into()),
        Request::Home(None),
        Request::Jog(Axis::X, Jog::To(Coordinate::new(-1.0))),
    ] {
        let refused = control.request(&request).unwrap_err();
        assert!(matches!(refused, Refusal::State(Need::StateAcknowledged)), "{refused}");
    }
    // a reset does not acknowledge it, and a short jog needs none of it
    control.request(&Request::Reset).unwrap();
    assert!(!control.alarms().last().unwrap().is_cleared);
    powered(&mut control);
    control.request(&Request::Jog(Axis::X, Jog::Increment(Coordinate::new(1.0)))).unwrap();
    for _ in 0..8000 {
        control.period();
    }
    control.request(&Request::AcknowledgeState).unwrap();
    assert!(control.alarms().last().unwrap().is_cleared);
    control.request(&Request::Home(None)).unwrap();
    assert!(control.request(&Request::AcknowledgeState).is_err(), "there is nothing any more");
}

#[test]
fn it_is_said_at_each_start_until_it_is_acknowledged_whatever_is_set_meanwhile() {
    let home = edited();
    let mut first = control(home.path());
    set(&mut first, -247.0);
    drop(first);
    let mut second = control(home.path());
    assert_eq!((g54_x(&second), second.state_changes().len()), (-247.0, 1));
    let raised = std::iter::from_fn(|| second.next_event());
    assert!(raised.into_iter().any(|event| matches!(event, Event::Alarm(a) if a.number == 601)));
    second.request(&Request::AcknowledgeState).unwrap();
    drop(second);
    assert_eq!(control(home.path()).state_changes(), []);
}

#[test]
fn a_damaged_file_costs_nothing_and_no_alarm() {
    let home = tempfile::tempdir().unwrap();
    let mut first = control(home.path());
    set(&mut first, -240.0);
    set(&mut first, -250.0);
    drop(first);
    let file = home.path().join("parameters.var");
    let mut bytes = fs::read(&file).unwrap();
    let at = bytes.len() / 2;
    bytes[at] ^= 1;
    fs::write(&file, bytes).unwrap();
    let mut second = control(home.path());
    assert_eq!((g54_x(&second), second.state_changes().len()), (-250.0, 0));
    let said: Vec<_> = std::iter::from_fn(|| second.next_event()).collect();
    let whole = "what the control wrote last is in force, from the manifest";
    let is_said = |event: &Event| matches!(event, Event::Notice(text) if text.contains(whole));
    assert!(said.iter().any(is_said), "{said:?}");
}

#[test]
fn another_machines_state_is_refused_with_both_names_whatever_is_missing_of_it() {
    let home = tempfile::tempdir().unwrap();
    set(&mut control(home.path()), -250.0);
    let refused = switched_on("lathe", home.path()).err().unwrap();
    for part in ["`tapping-center`", "`lathe`", "name another folder"] {
        assert!(refused.contains(part), "{refused}");
    }
    for name in ["manifest.toml", "manifest.copy.toml"] {
        fs::remove_file(home.path().join(name)).unwrap();
    }
    let refused = switched_on("lathe", home.path()).err().unwrap();
    assert!(refused.contains("`tapping-center`") && refused.contains("`lathe`"), "{refused}");
}

/// What a program believes of a tool is kept only where the next start can read it.
#[test]
fn no_program_writes_a_tool_that_the_next_start_refuses() {
    for (block, kept) in [
        ("G10 L1 P3 Z1000000", false),
        ("G10 L1 P3 Z-20000", false),
        ("G10 L1 P3 R100000", false),
        ("G10 L1 P3 R-3", false),
        ("G10 L10 P3 Z-500000", false),
        ("G20 G10 L1 P3 Z1000", false),
        ("G10 L1 P3 Z120.5 R3", true),
    ] {
        let home = tempfile::tempdir().unwrap();
        let mut first = crate::workpiece::control("tapping-center", home.path());
        let tool = |control: &Control| {
            let tool = control.tools().find(|tool| tool.number == 3).unwrap();
            (tool.length.value(), tool.diameter.value())
        };
        let before = tool(&first);
        first.request(&Request::ManualDataInput(block.into())).unwrap();
        crate::workpiece::until(&mut first, |control| !control.execution().is_under_way());
        let events = std::iter::from_fn(|| first.next_event());
        let said = events.filter(|event| matches!(event, Event::Notice(why) if why.contains("T3")));
        assert_eq!(said.count(), usize::from(!kept), "{block}");
        let after = tool(&first);
        assert_eq!(after == before, !kept, "{block}: {after:?}");
        drop(first);
        let second = switched_on("tapping-center", home.path()).unwrap();
        assert!(second.alarms().is_empty(), "{block}: {:?}", second.alarms());
        assert_eq!(tool(&second), after, "{block}");
    }
}

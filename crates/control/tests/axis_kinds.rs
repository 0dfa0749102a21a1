//! Linear and rotary axes read in their own units wherever a control says where they are.
use canon::Axis;
use control::job::ProgramOptions;
use control::operation::{Event, Jog, Request, Signals};
use control::{Control, ControlOptions};
use units::{Coordinate, CoordinateSpeed};

fn powered(machine: &str) -> Control {
    let options =
        ControlOptions { seed: Some(1), ..ControlOptions::simulated(ProgramOptions::on(machine)) };
    let mut control = Control::new(options).unwrap();
    control.request(&Request::Power(true)).unwrap();
    while !control.status().is_ready {
        control.period();
    }
    control
}

/// Home all five axes; what was said meanwhile.
fn home(control: &mut Control) -> Vec<String> {
    control.request(&Request::Home(None)).unwrap();
    let mut said = Vec::new();
    for _ in 0..400_000 {
        control.period();
        said.extend(notices(control));
        if said.iter().filter(|note| note.contains("is homed")).count() == 5 {
            break;
        }
    }
    assert!(control.is_homed_all(), "{said:?}");
    said
}

fn notices(control: &mut Control) -> Vec<String> {
    let next = || control.next_event();
    let text = |event| match event {
        Event::Notice(text) => Some(text),
        _ => None,
    };
    std::iter::from_fn(next).filter_map(text).collect()
}

fn refused(control: &mut Control, request: &Request) -> String {
    control.request(request).unwrap_err().to_string()
}

/// The five-axis mill with B in the place of A.
fn with_b(folder: &std::path::Path) -> String {
    let text = store::machine::embedded("mill-5-axis").unwrap();
    let path = folder.join("b.toml");
    std::fs::write(&path, text.replace("[axes.a", "[axes.b")).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn status_and_signals_say_degrees_of_rotary_axes_and_millimetres_of_linear_ones() {
    let control = powered("mill-5-axis");
    let status = control.status();
    let units: Vec<_> = status.axes.iter().map(|axis| (axis.letter, axis.unit)).collect();
    assert_eq!(units, [('X', "mm"), ('Y', "mm"), ('Z', "mm"), ('A', "deg"), ('C', "deg")]);
    let signals = Signals::of(&control);
    let names = signals.names();
    for name in ["A.setpoint_deg", "C.position_deg", "A.following_error_mdeg", "X.position_mm"] {
        assert!(names.iter().any(|found| found == name), "{name} of {names:?}");
    }
    let of_axis = |name: &&String| name[1..].starts_with('.');
    for name in names.iter().filter(of_axis) {
        let is_linear = ["mm", "um", "force_n"].iter().any(|unit| name.ends_with(unit));
        assert_eq!(is_linear, name.starts_with(['X', 'Y', 'Z']), "{name}");
    }
}

/// On B of a machine that none of the shipped ones is.
#[test]
fn homing_and_refused_jogs_say_the_unit_of_their_axis() {
    let folder = tempfile::tempdir().unwrap();
    let mut control = powered(&with_b(folder.path()));
    home(&mut control);
    let said = home(&mut control);
    for (letter, unit) in [("B", "°"), ("C", "°"), ("X", " mm")] {
        let begins = format!("{letter} is homed, ");
        let note = said.iter().find(|note| note.starts_with(&begins));
        let note = note.unwrap_or_else(|| panic!("{letter}: {said:?}"));
        assert!(note.ends_with(&format!("{unit} from before")), "{note}");
    }
    for _ in 0..4000 {
        control.period(); // it comes to rest
    }
    let far = Jog::To(Coordinate::new(400.0));
    let said = refused(&mut control, &Request::Jog(Axis::B, far));
    assert_eq!(said, "a jog of B goes from -110.000° to 110.000°, found 400°");
    let fast = Jog::Continuous(CoordinateSpeed::per_min(1e6));
    let said = refused(&mut control, &Request::Jog(Axis::B, fast));
    assert_eq!(said, "the speed of B per minute goes from -9000.000° to 9000.000°, found 1000000°");
    let said = refused(&mut control, &Request::Jog(Axis::X, Jog::To(Coordinate::new(4e3))));
    assert!(
        said.starts_with("a jog of X goes from ") && said.ends_with(" mm, found 4000 mm"),
        "{said}"
    );
}

#[test]
fn a_work_offset_is_said_in_the_unit_of_its_axis() {
    let mut control = powered("mill-5-axis");
    let set = |axis| Request::SetWorkOffset(2, axis, Coordinate::new(-7.5));
    let said = control.request(&set(Axis::C)).unwrap().notes;
    assert_eq!(said, ["G55: C is at -7.5000° of the machine"]);
    let said = control.request(&set(Axis::X)).unwrap().notes;
    assert_eq!(said, ["G55: X is at -7.5000 mm of the machine"]);
}

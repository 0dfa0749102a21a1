//! One control at a time has a machine simulator: others are refused, and orders do not wait for
//! its end.
use crate::common::{complained, leadscrew, said};
use crate::simulator::{Simulator, number, one_tap};
use bus::{Command, Machine as _};
use std::os::unix::net::UnixStream;
use units::{Coordinate, CoordinateSpeed, Force};
use wire::{Hello, Remote};

/// A control that has the machine and does nothing with it, and its line.
fn control(simulator: &Simulator) -> (Remote<UnixStream>, UnixStream) {
    let stream = UnixStream::connect(simulator.folder.path().join("simulator")).unwrap();
    let line = stream.try_clone().unwrap();
    let hello = Hello { name: "a test".into(), machine: "tapping-center".into() };
    (Remote::connect(stream, hello).unwrap(), line)
}

#[test]
fn a_second_control_is_refused_and_does_not_begin_when_the_first_ends() {
    let simulator = Simulator::start(&[]);
    let (mut first, line) = control(&simulator);
    first.exchange(&Command::default());
    for _ in 0..2 {
        let output = simulator.run(&one_tap("G84", 11), &[]);
        let why = complained(&output);
        assert_eq!(output.status.code(), Some(2), "{}{why}", said(&output));
        let process = format!("a test, process {}, has this machine", std::process::id());
        assert!(why.contains(&process), "{why}");
    }
    first.exchange(&Command::default());
    assert!(first.lost().is_none(), "{:?}", first.lost());
    line.shutdown(std::net::Shutdown::Both).unwrap(); // not closed alone: a process that is just started has a copy
    let after = simulator.status();
    assert_eq!((number(&after, "sessions"), &after["stop"]), (1.0, &"none".into()), "{after:#}");
    let output = simulator.run(&one_tap("G84", 11), &[]);
    assert_eq!(output.status.code(), Some(0), "{}{}", said(&output), complained(&output));
}

#[test]
fn orders_are_answered_while_a_control_has_the_machine() {
    let simulator = Simulator::start(&[]);
    let (mut first, _line) = control(&simulator);
    first.exchange(&Command::default());
    assert_eq!(number(&simulator.status(), "sessions"), 1.0);
    let socket = simulator.folder.path().join("simulator");
    let recover = ["recover", "--tool-is-free", "--simulator", socket.to_str().unwrap()];
    let state = simulator.state();
    let free = leadscrew(&[&recover[..], &["--state", state.to_str().unwrap()]].concat());
    assert_eq!(free.status.code(), Some(2), "{}", said(&free));
    assert!(complained(&free).contains("has this machine"), "{}", complained(&free));
    let cut = leadscrew(&["simulator", "--power-cut", socket.to_str().unwrap()]);
    assert_eq!(cut.status.code(), Some(0), "{}", complained(&cut));
    first.exchange(&Command::default());
    assert!(first.lost().is_some(), "its mains have failed");
    let (mut second, _line) = control(&simulator);
    second.exchange(&Command::default());
    let quit = leadscrew(&["simulator", "--quit", socket.to_str().unwrap()]);
    assert_eq!(quit.status.code(), Some(0), "{}", complained(&quit));
    second.exchange(&Command::default());
    assert!(second.lost().is_some(), "there is no machine any more");
}

#[test]
fn a_command_that_no_control_would_give_is_not_obeyed() {
    type Spoil = fn(&mut Command);
    let spoils: [(&str, Spoil); 5] = [
        ("says what cannot be", |c| c.axes[2].position = Coordinate::new(f64::NAN)),
        ("says what cannot be", |c| c.axes[2].force = Force::n(f64::NAN)),
        ("jumps from", |c| c.axes[2].position -= Coordinate::new(5.0)),
        ("beyond its stops", |c| c.axes[2].position = Coordinate::new(-1e4)),
        ("is ordered", |c| c.axes[2].speed = CoordinateSpeed::new(1e4)),
    ];
    for (why, spoil) in spoils {
        let simulator = Simulator::start(&[]);
        let (mut first, _line) = control(&simulator);
        let stands = first.feedback().axes[2].position;
        let mut command = Command::default();
        command.axes[2].enable = true;
        command.axes[2].position = stands;
        command.axes[2].force = Force::n(3000.0); // which holds its weight
        first.exchange(&command);
        assert!(first.lost().is_none(), "{:?}", first.lost());
        spoil(&mut command);
        first.exchange(&command);
        let lost = first.lost().map(ToString::to_string).unwrap_or_default();
        assert!(lost.contains(why), "{lost}");
        let after = simulator.status();
        assert!((number(&after, "z_mm") - stands.value()).abs() < 0.5, "{why}: {after:#}");
    }
}

#[test]
fn a_client_that_says_nothing_keeps_no_control_from_the_machine() {
    let simulator = Simulator::start(&[]);
    let socket = simulator.folder.path().join("simulator");
    let _silent = UnixStream::connect(&socket).unwrap();
    let (mut control, _line) = control(&simulator);
    control.exchange(&Command::default());
    assert!(control.lost().is_none());
}

#[test]
fn only_a_socket_is_replaced_by_the_one_that_is_listened_at() {
    let folder = tempfile::tempdir().unwrap();
    let [file, link] = ["part.ngc", "link"].map(|name| folder.path().join(name));
    std::fs::write(&file, "G0 X1\nM2\n").unwrap();
    std::os::unix::fs::symlink(&file, &link).unwrap();
    for path in [&file, &link] {
        let output = leadscrew(&["simulator", "--listen", path.to_str().unwrap()]);
        let why = complained(&output);
        assert!(output.status.code() == Some(2) && why.contains("it is no socket"), "{why}");
        assert_eq!(std::fs::read_to_string(path).unwrap(), "G0 X1\nM2\n");
    }
}

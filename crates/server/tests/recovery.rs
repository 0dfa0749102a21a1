//! A control that is cut off from its machine in a tap, and what the next one knows of it: over
//! HTTP, as a page has it.

use crate::common::Served;
use leadscrew::simulator::{SimulatorOptions, SimulatorProcess, order};
use serde_json::{Value, json};
use std::io::{Read as _, Write as _};
use std::net::Shutdown;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};

/// Two holes, drilled and tapped M6, 20 mm deep.
const PART: &str = "G21 G90 G54\nT2 M6\nG43 H2\nS6000 M3\nG0 X12 Y12 Z30\n\
    G99 G83 X12 Y12 Z-24 R2 Q8 F900\nX44\nG80\nG0 Z50\nT3 M6\nG43 H3\nS1000 M3\nG0 X12 Y12 Z30\n\
    G99 G84 X12 Y12 Z-20 R5 F1000\nX44\nG80\nG0 Z100\nM5\nM30\n";

/// A machine simulator that listens at this socket, in a thread, until it is told to end.
fn simulator(socket: &Path) {
    let options = SimulatorOptions {
        source: control::job::ProgramOptions::on("tapping-center"),
        material: None,
        seed: None,
        real_time: false,
        power_cuts: Vec::new(),
        on_link_loss: None,
        on_power_loss: None,
        single_turn: false,
        serial: 1,
        epoch: Some(1),
    };
    let listening = SimulatorProcess::new(&options).unwrap().listen(socket).unwrap();
    std::thread::spawn(move || listening.serve(|_| {}));
}

/// A line to the simulator that can be cut: its two ends.
fn line(socket: &Path, to: &Path) -> Receiver<[UnixStream; 2]> {
    let (listener, to) = (UnixListener::bind(socket).unwrap(), PathBuf::from(to));
    let (ends, taken) = channel();
    std::thread::spawn(move || {
        let (control, _) = listener.accept().unwrap();
        let machine = UnixStream::connect(to).unwrap();
        ends.send([control.try_clone().unwrap(), machine.try_clone().unwrap()]).unwrap();
        let back = (machine.try_clone().unwrap(), control.try_clone().unwrap());
        std::thread::spawn(move || relay(back.0, back.1));
        relay(control, machine);
    });
    taken
}

fn relay(mut from: UnixStream, mut to: UnixStream) {
    let mut bytes = [0; 4096];
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        if to.write_all(&bytes[..count]).is_err() {
            return;
        }
    }
}

fn told(socket: &Path) -> Value {
    serde_json::from_str(&order(socket, wire::Order::Status).unwrap()).unwrap()
}

#[test]
fn a_tool_that_a_lost_control_has_left_in_its_thread_is_known_and_taken_out_by_the_next() {
    let dir = tempfile::tempdir().unwrap();
    let [machine, cable] = ["machine", "cable"].map(|name| dir.path().join(name));
    let state = dir.path().join("state");
    simulator(&machine);
    let ends = line(&cable, &machine);
    let served = Served::outside(4.0, &state, &cable);
    served.power_on();
    served.home();
    assert_eq!(served.put("/programs/part.ngc", PART.as_bytes()).0, 200);
    served.accepted(json!({ "request": "load", "program": "part.ngc" }));
    served.accepted(json!({ "request": "start" }));
    served.until("deep in its second thread", |status| {
        let z = status["axes"][2]["work"].as_f64().unwrap();
        status["activity"] == "tap-in" && status["features"]["good"] == 3 && z < -8.0
    });
    for end in ends.recv().unwrap() {
        end.shutdown(Shutdown::Both).unwrap();
    }
    served.until("an alarm", |status| status["alarms"] != json!([]));
    drop(served);
    let stopped = told(&machine);
    assert_eq!((&stopped["tap_in_thread"], &stopped["tool_in_work"]), (&json!(true), &json!(3)));

    let served = Served::outside(4.0, &state, &machine);
    let status = served.status();
    let left = &status["left_in_work"];
    assert_eq!((&status["is_tool_in_work"], &status["power"]), (&json!(true), &json!("OFF")));
    assert_eq!((&left["tool"], &left["hole"], &left["line"]), (&json!(3), &json!(4), &json!(15)));
    assert_eq!(left["refused"], Value::Null, "{left}");
    assert!(left["program"].as_str().unwrap().ends_with("part.ngc"), "{left}");
    // what is said lies around what is: the simulator knows it
    let depth = left["depth_mm"].as_f64().unwrap();
    assert!((8.0..=20.5).contains(&depth), "{left}");
    let [off, within] = ["off_thread_um", "within_um"].map(|name| left[name].as_f64().unwrap());
    let truth = stopped["off_helix_um"].as_f64().unwrap();
    assert!((off - truth).abs() <= within, "{off} µm within {within} µm, and it is {truth} µm");
    // nothing but a recovery moves
    for request in [
        json!({ "request": "power", "on": true }),
        json!({ "request": "home" }),
        json!({ "request": "jog_increment", "axis": "Z", "by_mm": 1 }),
        json!({ "request": "retract" }),
    ] {
        let (status, answer) = served.request(&request);
        assert!(matches!(status, 409 | 422), "{request}: {answer}");
    }
    served.accepted(json!({ "request": "recover" }));
    served.until("out", |status| status["is_tool_in_work"] == false);
    assert_eq!(served.status()["left_in_work"], Value::Null);

    // by another text it is not cut again without a word, though the program lies elsewhere now
    served.home();
    let edited = format!("{PART}(edited)\n");
    assert_eq!(served.put("/programs/part.ngc", edited.as_bytes()).0, 200);
    served.accepted(json!({ "request": "load", "program": "part.ngc" }));
    served.accepted(json!({ "request": "search", "hole": 4 }));
    for _ in 0..2 {
        let (_, answer) = served.request(&json!({ "request": "start" }));
        let reason = answer["reason"].as_str().unwrap_or_default();
        assert!(reason.contains("was changed since a tool was taken out of it"), "{answer}");
    }
    // and the thread is cut again, from its hole on
    assert_eq!(served.put("/programs/part.ngc?replace=true", PART.as_bytes()).0, 200);
    served.accepted(json!({ "request": "load", "program": "part.ngc" }));
    served.accepted(json!({ "request": "search", "hole": 4 }));
    served.accepted(json!({ "request": "start" }));
    let status = served.until("the end", |status| status["execution"] == "PROGRAM_COMPLETED");
    let features = served.get("/features").1;
    assert_eq!(
        status["features"],
        json!({ "good": 4, "failed": 0, "not_judged": 0 }),
        "three of the same workpiece were judged before: {features}"
    );
    drop(served);
    let after = told(&machine);
    assert_eq!((&after["tool_broken"], &after["tool_in_work"]), (&json!(false), &Value::Null));
    order(&machine, wire::Order::Quit).unwrap();
}

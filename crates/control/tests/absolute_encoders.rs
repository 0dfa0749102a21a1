//! Axes whose encoders are absolute are homed once: a control that is switched on again knows where
//! they are.
use control::job::ProgramOptions;
use control::operation::Request;
use control::{Control, ControlOptions};
use std::path::Path;

fn powered(state: &Path, seed: u64) -> Control {
    let options = ControlOptions {
        seed: Some(seed),
        state: Some(state.to_owned()),
        ..ControlOptions::simulated(ProgramOptions::on("bench-xyz"))
    };
    let mut control = Control::new(options).unwrap();
    control.request(&Request::Power(true)).unwrap();
    while !control.status().is_ready {
        control.period();
    }
    control.period();
    control
}

#[test]
fn an_absolute_encoder_is_referenced_once_for_each_machine() {
    let folder = tempfile::tempdir().unwrap();
    let mut control = powered(folder.path(), 1);
    assert!(!control.is_homed_all());
    control.request(&Request::Home(None)).unwrap();
    for _ in 0..10 {
        control.period();
    }
    assert!(control.is_homed_all());
    drop(control);
    assert!(powered(folder.path(), 1).is_homed_all());
    // another machine of the same file has other encoders
    assert!(!powered(folder.path(), 2).is_homed_all());
}

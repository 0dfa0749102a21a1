//! Whatever a configuration wires of LinuxCNC's own components, and whatever its INI file says, has
//! a line in what the import says; what stopped the machine has an answer before drives are led.
#![allow(clippy::unwrap_used)] // a test may panic
use super::{Hal, Ini, RemarkKind, import};
use crate::machine;
use proptest::prelude::*;

const MILL: &str = include_str!("../../../../machines/hal/from/mill.ini");

fn read(ini: &str, wiring: &str) -> (Option<String>, Vec<String>) {
    let absent = |_: &str| Err("is not there".to_owned());
    let ini = Ini::read("mill.ini", ini, &mut absent.clone());
    let mut hal = Hal::default();
    hal.read("mill.hal", wiring, &ini, &mut absent.clone());
    let (text, remarks) = import(&ini, &hal);
    (text, remarks.iter().map(ToString::to_string).collect())
}

/// The guards of a machine file that have no answer.
fn unanswered(text: &str) -> Vec<String> {
    machine::parse(text, 0)
        .unwrap_or_else(|found| panic!("{found:#?}\n{text}"))
        .hal
        .unwrap()
        .unanswered
}

#[test]
fn a_door_that_inhibits_feed_and_spindle_is_asked_for_with_pin_file_and_line() {
    let door = "net door door.open => motion.feed-inhibit\nnet door => spindle.0.inhibit\n";
    let (text, remarks) = read(MILL, door);
    let text = text.unwrap();
    let open = unanswered(&text);
    assert_eq!(open.len(), 2, "{open:#?}");
    assert!(open[0].contains("motion.feed-inhibit") && open[0].contains("mill.hal:1"), "{open:#?}");
    assert!(open[1].contains("spindle.0.inhibit") && open[1].contains("mill.hal:2"), "{open:#?}");
    let safety =
        "safety   spindle.0.inhibit: on signal door, mill.hal:2: \"leadscrew.spindle.0.inhibit\"";
    assert!(remarks.iter().any(|line| line.starts_with(safety)), "{remarks:#?}");

    // the answers: one pin is wired, the other one is not needed
    let unanswered_lines = text.lines().filter(|line| line.contains("= \"unanswered"));
    let answers = unanswered_lines.zip(["leadscrew.feed-inhibit", "not needed"]);
    let answered = answers.fold(text.clone(), |text, (line, answer)| {
        let key = line.split(" = ").next().unwrap();
        text.replace(line, &format!("{key} = \"{answer}\""))
    });
    assert!(unanswered(&answered).is_empty());
    let watched = machine::parse(&answered, 0).unwrap().hal.unwrap().watched;
    assert!(watched.has(bus::WatchedInput::FeedInhibit));
    assert!(!watched.has(bus::WatchedInput::SpindleInhibit(0)));
}

#[test]
fn what_stops_the_machine_in_linuxcnc_is_a_question_however_it_is_wired() {
    for wiring in [
        "net loop iocontrol.0.user-enable-out",
        "linksp hold motion.feed-hold",
        "linkps halui.program.pause hold",
        "linkpp estop.out halui.estop.activate",
        "setp motion.enable 1",
        "motion.jog-inhibit = 1",
        "net on motion.enable",
        "net unknown motion.some-inhibit",
        "source missing.hal",
    ] {
        let (text, remarks) = read(MILL, wiring);
        assert_eq!(unanswered(&text.unwrap()).len(), 1, "{wiring}: {remarks:#?}");
        assert!(remarks.iter().any(|line| line.starts_with("safety ")), "{remarks:#?}");
    }
}

#[test]
fn a_key_is_taken_or_not_read_and_a_file_that_is_not_there_is_missing() {
    let more = "COMP_FILE = x.comp\nCOMP_FILE_TYPE = 1\nFERROR = 3\n[LASER]\nPOWER = 3\n[HAL]\nSHUTDOWN = off.hal\n";
    let (_, remarks) = read(&format!("{MILL}{more}"), "setp laser.0.power [LASER]POWER\n");
    for (kind, part) in [
        ("missing", "[JOINT_2]COMP_FILE = x.comp: is not there"),
        ("not read", "[JOINT_2]COMP_FILE_TYPE = 1"),
        ("not read", "[JOINT_2]FERROR = 3: the first one counts"),
        ("not read", "[LASER]POWER = 3: a section of its own; the HAL file takes its value"),
        ("not read", "[HAL]SHUTDOWN = off.hal"),
        ("taken", "[TRAJ]COORDINATES"),
    ] {
        let has = |line: &&String| line.starts_with(kind) && line.contains(part);
        assert!(remarks.iter().any(|line| has(&line)), "{kind} {part}: {remarks:#?}");
    }
}

/// Lines in which a word stands by itself.
fn named(remarks: &[String], word: &str) -> usize {
    let is_end =
        |c: Option<char>| !c.is_some_and(|c| c.is_ascii_alphanumeric() || "-_.".contains(c));
    let has = |line: &&String| {
        line.match_indices(word).any(|(at, _)| {
            is_end(line[..at].chars().last()) && is_end(line[at + word.len()..].chars().next())
        })
    };
    remarks.iter().filter(has).count()
}

proptest! {
    #[test]
    fn each_pin_of_linuxcncs_own_components_that_is_wired_or_set_has_its_line(
        pins in proptest::collection::vec(
            "(motion|joint\\.[0-4]|axis\\.[xyz]|spindle\\.[01]|iocontrol\\.0|halui|ini\\.x)\\.[a-z]{1,9}(-(in|out|enable|inhibit|0[0-9]))?(\\.[a-z]{2,7})?", 1..8),
        known in proptest::sample::subsequence(vec![
            "joint.0.motor-pos-cmd", "joint.3.motor-pos-fb", "joint.1.index-enable", "joint.2.jog-counts",
            "axis.x.eoffset-enable", "spindle.0.inhibit", "spindle.0.on", "motion.digital-in-03",
            "iocontrol.0.tool-prepare", "iocontrol.0.emc-enable-in", "halui.machine.is-on", "halui.joint.0.home",
            "motion.feed-hold", "motion.tooloffset.z", "motion.adaptive-feed"], 1..15),
        how in 0..4_usize,
        broken in any::<bool>(),
    ) {
        let all: Vec<&str> = pins.iter().map(String::as_str).chain(known).collect();
        let wiring: String = all.iter().enumerate().map(|(at, pin)| match how {
            0 => format!("net s{at} {pin} => other.{at}.in\n"),
            1 => format!("linksp s{at} {pin}\n"),
            2 => format!("linkpp other.{at}.out {pin}\n"),
            _ => format!("setp {pin} 1\n"),
        }).collect();
        let ini = if broken { MILL.replace("trivkins", "pumakins") } else { MILL.to_owned() };
        let (text, remarks) = read(&ini, &wiring);
        for pin in all {
            prop_assert!(named(&remarks, pin) > 0, "{pin}: {remarks:#?}");
        }
        prop_assert_eq!(text.is_some(), !broken);
        if let Some(text) = text {
            let safety = remarks.iter().filter(|line| line.starts_with("safety ")).count();
            prop_assert_eq!(unanswered(&text).len(), safety, "{}", text);
        }
    }

    #[test]
    fn each_key_of_an_ini_file_has_its_line(
        keys in proptest::collection::vec(("(TRAJ|KINS|EMC|HAL|JOINT_0|AXIS_Z|DISPLAY|OWN)", "[A-Z]{1,5}(_[A-Z]{1,4})?", "[a-z0-9 ]{0,6}"), 1..9),
    ) {
        let line = |more: String, (section, key, value): &(String, String, String)| {
            more + &format!("[{section}]\n{key} = {value}\n")
        };
        let more = keys.iter().fold(String::new(), line);
        let ini = format!("{MILL}{more}");
        let (_, remarks) = read(&ini, "");
        let own = Ini::read("mill.ini", &ini, &mut |_| Err(String::new()));
        for entry in &own.entries {
            let cited = entry.cited();
            prop_assert!(remarks.iter().any(|line| line.contains(&cited)), "{cited}: {remarks:#?}");
        }
    }
}

#[test]
fn no_line_is_of_no_kind() {
    let kinds = [RemarkKind::Rewire, RemarkKind::Unread, RemarkKind::Safety, RemarkKind::Wrong];
    assert!(kinds.is_sorted(), "what a person must answer stands at the end, what is wrong last");
}

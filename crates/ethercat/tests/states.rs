//! The states of CiA 402 against those of an independent program.
use esc::{DriveState, next_state, status_word};
use ethercat::cia402::{PdsState, Wanted, control_word, state};
use std::collections::BTreeMap;

const TABLE: &str = include_str!("cia402-states.txt");

fn named(state: Option<PdsState>) -> &'static str {
    match state {
        None => "NONE",
        Some(PdsState::NotReadyToSwitchOn) => "NOT READY TO SWITCH ON",
        Some(PdsState::SwitchOnDisabled) => "SWITCH ON DISABLED",
        Some(PdsState::ReadyToSwitchOn) => "READY TO SWITCH ON",
        Some(PdsState::SwitchedOn) => "SWITCHED ON",
        Some(PdsState::OperationEnabled) => "OPERATION ENABLED",
        Some(PdsState::QuickStopActive) => "QUICK STOP ACTIVE",
        Some(PdsState::FaultReactionActive) => "FAULT REACTION ACTIVE",
        Some(PdsState::Fault) => "FAULT",
    }
}

const DRIVE_STATES: [DriveState; 8] = [
    DriveState::NotReadyToSwitchOn,
    DriveState::SwitchOnDisabled,
    DriveState::ReadyToSwitchOn,
    DriveState::SwitchedOn,
    DriveState::OperationEnabled,
    DriveState::QuickStopActive,
    DriveState::FaultReactionActive,
    DriveState::Fault,
];

fn states() -> Vec<&'static str> {
    let rows = TABLE.lines().filter_map(|row| row.strip_prefix("status "));
    rows.map(|row| row.split_once(' ').unwrap().1).collect()
}

/// Control word, state before, state after.
fn transitions() -> Vec<(u16, &'static str, &'static str)> {
    let rows = TABLE.lines().filter_map(|row| row.strip_prefix("control "));
    let row = |row: &'static str| {
        let (control, states) = row.split_once(' ').unwrap();
        let (before, after) = states.split_once(" > ").unwrap();
        (u16::from_str_radix(control, 16).unwrap(), before, after)
    };
    rows.map(row).collect()
}

#[test]
fn all_status_words_mean_what_an_independent_program_takes_them_for() {
    let expected = states();
    assert_eq!(expected.len(), 0x80);
    for word in 0..=u16::MAX {
        assert_eq!(named(state(word)), expected[usize::from(word & 0x7F)], "{word:04X}");
    }
}

#[test]
fn the_emulated_drive_shows_the_states_that_an_independent_program_reads() {
    let expected = states();
    for drive in DRIVE_STATES {
        let word = status_word(drive);
        assert_eq!(named(state(word)).replace(' ', ""), format!("{drive:?}").to_uppercase());
        assert_eq!(named(state(word)), expected[usize::from(word & 0x7F)]);
    }
}

/// But for transition 16, from quick stop back, which a drive need not have.
#[test]
fn the_emulated_drive_has_the_transitions_of_an_independent_program() {
    let by_name = |name: &str| {
        let squeezed = name.replace(' ', "");
        DRIVE_STATES
            .into_iter()
            .find(|state| format!("{state:?}").to_uppercase() == squeezed)
            .unwrap()
    };
    let mut seen = 0;
    for (control, before, after) in transitions() {
        if (before, after) == ("QUICK STOP ACTIVE", "OPERATION ENABLED") {
            continue;
        }
        assert_eq!(next_state(by_name(before), control, 0), by_name(after), "{before} > {after}");
        seen += 1;
    }
    assert_eq!(seen, 14);
}

#[test]
fn each_control_word_is_that_of_a_transition_of_an_independent_program() {
    let orders: BTreeMap<(&str, &str), u16> = transitions()
        .into_iter()
        .map(|(control, before, after)| ((before, after), control))
        .collect();
    let path = [
        ("SWITCH ON DISABLED", "READY TO SWITCH ON"),
        ("READY TO SWITCH ON", "SWITCHED ON"),
        ("SWITCHED ON", "OPERATION ENABLED"),
    ];
    for (before, after) in path {
        let status = status_word(
            DRIVE_STATES.into_iter().find(|s| named(state(status_word(*s))) == before).unwrap(),
        );
        assert_eq!(control_word(status, Wanted::On, false), orders[&(before, after)]);
    }
    let down = [
        ("OPERATION ENABLED", "SWITCHED ON"),
        ("SWITCHED ON", "READY TO SWITCH ON"),
        ("READY TO SWITCH ON", "SWITCH ON DISABLED"),
        ("QUICK STOP ACTIVE", "SWITCH ON DISABLED"),
    ];
    for (before, after) in down {
        let status = status_word(
            DRIVE_STATES.into_iter().find(|s| named(state(status_word(*s))) == before).unwrap(),
        );
        assert_eq!(control_word(status, Wanted::Off, false), orders[&(before, after)]);
    }
    let fault = status_word(DriveState::Fault);
    assert_eq!(control_word(fault, Wanted::On, true), orders[&("FAULT", "SWITCH ON DISABLED")]);
    let enabled = status_word(DriveState::OperationEnabled);
    let stop = control_word(enabled, Wanted::QuickStop, false);
    assert_eq!(stop, orders[&("OPERATION ENABLED", "QUICK STOP ACTIVE")]);
}

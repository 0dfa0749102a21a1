//! RS-274/NGC as LinuxCNC 2.9 reads it: the shared language, of which the other dialects say where
//! they differ.
//!
//! Source: NISTIR 6556; LinuxCNC 2.9 manual, "G codes", "M codes", "O codes".
use crate::dialect::rules::{DepthFrom, Family, FrontEndKind, Rules, StartUp};
use gcode::Grammar;

/// What the shared language does.
pub(crate) const RULES: Rules = Rules {
    name: "linuxcnc",
    people: "LinuxCNC",
    about: "RS-274/NGC as LinuxCNC 2.9 reads it",
    roles: &[],
    grammar: Grammar::Rs274,
    front_end: FrontEndKind::Rs274,
    codes: None,
    own_codes: &[],
    evidence: &[Family::LinuxCnc, Family::Probing],
    turret: false,
    depth_from: DepthFrom::RPlane,
    starts_at_initial_level: false,
    repeats: b'L',
    no_repetition: false,
    chip_removal: false,
    drilling_waits: false,
    taps_keep_dwell: true,
    taps_turn_spindle: false,
    restates_modes: false,
    start_up: StartUp::BesideEnd,
    external_offset: false,
    lead_along_axis: false,
    keeps_speed: false,
    keeps_levels: false,
    grinds_by_feed: false,
    ends_with_text: false,
    begins_rapidly: false,
    has_laser: false,
    dwells_by_s: false,
    ends_scaling: false,
    machine_place_in_increments: false,
    last_code_acts: false,
    needs_axis_words: false,
    lacks: &[],
    tools_by_hand: false,
    idle: 0,
    short_radius: [0.00127, 0.00005],
    reads_up_to_fault: false,
};

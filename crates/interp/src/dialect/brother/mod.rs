//! Brother's tapping centres: the shared language with cycles of their own.
//!
//! ```text
//!   G77, G78   synchronised tapping by its pitch      cycles/holes/synchro_tap.rs
//!   G100       non-stop tool change                   auxiliary/tool_change.rs
//!   K          counts repetitions, in the place of L
//!   U, E       chip removal on the way                cycles/holes/chip_removal.rs
//! ```
//!
//! In this dialect G84 and G74 turn the spindle themselves as well: S in their block is enough.
//!
//! Source: the word lists of posts for these controls (Autodesk's for CNC-A00, -B00 and -C00),
//! where they agree; what the control's parameters choose (I and J of other cycles) is left to
//! them.
use crate::dialect::{
    linuxcnc,
    rules::{DepthFrom, Family, OwnCode, Rules},
};
use crate::{
    codes::{NON_STOP_CHANGE, SYNCHRO_LEFT, SYNCHRO_RIGHT, set},
    dialect::rules::Role,
};

/// Where they differ from the shared language.
pub(crate) const RULES: Rules = Rules {
    name: "brother",
    people: "Brother's controls",
    about: "Cycles as Brother's tapping centres have them: K repeats, U and E throw chips off",
    roles: &[Role {
        letter: b'K',
        codes: &["G73", "G74", "G81", "G82", "G83", "G84", "G85", "G86", "G87", "G88", "G89"],
        what: "how many holes in a row",
    }],
    own_codes: &[
        OwnCode { written: 77, code: SYNCHRO_RIGHT, beside: set("KS") },
        OwnCode { written: 78, code: SYNCHRO_LEFT, beside: set("KS") },
        OwnCode { written: 100, code: NON_STOP_CHANGE, beside: set("ST") },
    ],
    evidence: &[Family::Brother],
    depth_from: DepthFrom::InitialLevel,
    starts_at_initial_level: true,
    repeats: b'K',
    chip_removal: true,
    drilling_waits: true,
    taps_keep_dwell: false,
    taps_turn_spindle: true,
    restates_modes: true,
    ..linuxcnc::RULES
};

//! Fanuc's controls in the shared language: what they differ in once the front end has read their
//! words.
#![allow(clippy::match_same_arms)] // a row of a table each
pub(crate) mod catalogue;
pub(crate) mod codes;
pub(crate) mod counts;
pub(crate) mod kind;
pub(crate) mod meaning;
pub(crate) mod variant;

use crate::{
    codes::set,
    dialect::{
        fanuc::kind::Kind,
        linuxcnc,
        rules::{Family, FrontEndKind, Role, Rules, StartUp},
    },
};
use gcode::Grammar;

/// Machining centres.
pub(crate) const MILL: Rules = Rules {
    name: "fanuc",
    people: "Fanuc's machining centres",
    about: "Fanuc's machining centres: custom macro B, least input increments",
    grammar: Grammar::Fanuc,
    front_end: FrontEndKind::Fanuc(Kind::Mill),
    codes: Some(&Kind::Mill),
    evidence: &[Family::Fanuc, Family::FanucMill],
    no_repetition: true,
    taps_keep_dwell: false,
    restates_modes: true,
    last_code_acts: true,
    start_up: StartUp::BesideNext,
    external_offset: true,
    lead_along_axis: true,
    keeps_speed: true,
    keeps_levels: true,
    reads_up_to_fault: true,
    idle: set("DHPQ"),
    short_radius: [0.005, 0.0002],
    ..linuxcnc::RULES
};

/// Lathes, G code system A.
pub(crate) const LATHE_A: Rules = Rules {
    name: "fanuc-lathe-a",
    people: "Fanuc's lathes (system A)",
    about: "Fanuc's lathes, G code system A",
    front_end: FrontEndKind::Fanuc(Kind::LatheA),
    codes: Some(&Kind::LatheA),
    evidence: &[Family::Fanuc, Family::FanucLathe],
    turret: true,
    ..MILL
};

/// Lathes, G code system B.
pub(crate) const LATHE_B: Rules = Rules {
    name: "fanuc-lathe-b",
    people: "Fanuc's lathes (system B)",
    about: "Fanuc's lathes, G code system B",
    front_end: FrontEndKind::Fanuc(Kind::LatheB),
    codes: Some(&Kind::LatheB),
    ..LATHE_A
};

/// Lathes, G code system C.
pub(crate) const LATHE_C: Rules = Rules {
    name: "fanuc-lathe-c",
    people: "Fanuc's lathes (system C)",
    about: "Fanuc's lathes, G code system C",
    front_end: FrontEndKind::Fanuc(Kind::LatheC),
    codes: Some(&Kind::LatheC),
    ..LATHE_A
};

/// What letters do beside G12 and G13, on the machining centres that have them.
pub(crate) const POCKET: [Role; 5] = [
    of_pocket(b'I', "radius of the circle, of the first one with K"),
    of_pocket(b'K', "radius of the last circle"),
    of_pocket(b'Q', "how much larger each circle is than the one before"),
    of_pocket(b'D', "the offset whose radius is taken away"),
    of_pocket(b'Z', "level that is fed to before"),
];

const fn of_pocket(letter: u8, what: &'static str) -> Role {
    Role { letter, codes: &["G12", "G13"], what }
}

//! Grbl 1.1, and what took its place on small machines (`grblHAL`, `FluidNC`): the shared language
//! as senders stream it.
//!
//! ```text
//!   $H  ?  ~  !       for the sender or the controller: left out, with a remark
//!   X10 Y5            G0 is in force where a program begins
//!   (the end)         a program ends where its text does: M2 and M30 may be missing
//!   G4 S2             waits for two seconds, as Marlin does, with a remark
//!   G50               the end of a scaling, which never begins here: left out, with a remark
//!   T1                names the tool that is clamped by hand: no M6 has to follow
//!   G91 G53 G0 X0     a machine coordinate
//!   G3 I-4.5          refused: error 26 there; X10 Y5 of where it stands makes a full circle
//!   G41, G84, G52 …   executed, with a remark: error 20 there
//!   G2 … K0, D1       words that no code takes have no effect, with a remark
//! ```
//!
//! What Grbl itself lacks (cycles, tool lengths, O-words) is read all the same: grblHAL has most of
//! it.
//!
//! Mach3's and Tormach's posts (`PathPilot`) write G50 in the first block of each program.
//!
//! Source: Grbl's documentation, "Grbl v1.1 Interface" and "Commands"; the code lists of `grblHAL`
//! and `FluidNC`.
use crate::codes::set;
use crate::dialect::{
    linuxcnc,
    rules::{Family, Rules},
};
use gcode::Grammar;

/// What neither Grbl 1.1 nor grblHAL has, which answer error 20: cutter compensation, cycles with a
/// spindle that turns back, G52, G90.1, NURBS, G61.1, G92.3.
const LACKS: [u16; 22] = [
    52,
    53,
    331,
    410,
    411,
    420,
    421,
    512,
    520,
    611,
    740,
    810 + 30,
    842,
    843,
    870,
    880,
    901,
    923,
    962,
    1510,
    1530,
    1540,
];

/// Where they differ from the shared language.
pub(crate) const RULES: Rules = Rules {
    name: "grbl",
    people: "Grbl and its kin",
    about: "Grbl 1.1 and what took its place: as hobby CAM makes programs and senders stream them",
    grammar: Grammar::Grbl,
    evidence: &[Family::Grbl, Family::Probing],
    restates_modes: true,
    ends_with_text: true,
    begins_rapidly: true,
    has_laser: true,
    dwells_by_s: true,
    ends_scaling: true,
    machine_place_in_increments: true,
    needs_axis_words: true,
    lacks: &LACKS,
    tools_by_hand: true,
    idle: set("DHKPQ"),
    short_radius: [0.005, 0.0002],
    ..linuxcnc::RULES
};

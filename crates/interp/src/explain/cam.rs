//! I11: cam grinding.
use crate::explain::finding::{Finding, row};

pub(super) const ROWS: &[Finding] = &[
    row("I1101", "Cam grinding needs a profile first.", "G150", "G151 P7\nG150"),
    row("I1102", "G151 needs the number of a profile.", "G151", "G151 P7"),
    row(
        "I1103",
        "Grinding needs the speed of the work.",
        "G151 P7\nG154 X-0.1 F0.05",
        "G151 P7\nG154 X-0.1 F0.05 S60",
    ),
    row(
        "I1104",
        "G154 takes something off (X) or turns on (P).",
        "G151 P7\nG154 S60",
        "G151 P7\nG154 S60 P2",
    ),
    row(
        "I1105",
        "X of grinding goes towards the work.",
        "G151 P7\nG154 X0.1 F0.05 S60",
        "G151 P7\nG154 X-0.1 F0.05 S60",
    ),
    row(
        "I1106",
        "Grinding needs the infeed of each turn.",
        "G151 P7\nG154 X-0.1 S60",
        "G151 P7\nG154 X-0.1 F0.05 S60",
    ),
    row(
        "I1107",
        "The rate cannot make the infeed within the turn.",
        "G151 P7\nG154 X-0.1 F0.1 R0.05 S60",
        "G151 P7\nG154 X-0.1 F0.1 R0.2 S60",
    ),
    row(
        "I1108",
        "A cam is ground along X of the machine: the work offset may not be turned.",
        "G10 L2 P1 R30\nG151 P7",
        "G10 L2 P1 R0\nG151 P7",
    ),
];

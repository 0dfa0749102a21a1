//! I06: spindle, tools, offsets, outputs.
use crate::explain::finding::{Finding, row};

pub(super) const ROWS: &[Finding] = &[
    row("I0601", "G96 needs the surface speed.", "G96", "G96 S120"),
    row("I0602", "A speed is not negative.", "S-100", "S100 M4"),
    row("I0603", "There is one spindle, $0.", "S100 M3 $2", "S100 M3 $0"),
    row("I0604", "M61 needs the number of the tool.", "M61", "M61 Q1"),
    row("I0605", "M19 needs the angle.", "M19", "M19 R90"),
    row("I0606", "The angle of M19 is between 0 and 360 degrees.", "M19 R400", "M19 R40"),
    row("I0607", "M19 waits a time above 0.", "M19 R90 Q0", "M19 R90 Q5"),
    row("I0608", "A dwell is not negative.", "G4 P-1", "G4 P1"),
    row("I0609", "G4 needs the seconds to wait.", "G4", "G4 P1"),
    row("I0610", "Tools have whole numbers.", "T1.5 M6", "T1 M6"),
    row("I0611", "The tool is not in the tool table.", "T77 M6", "T1 M6"),
    row(
        "I0612",
        "G43.2 needs the number of a tool, or axis words.",
        "G43.2 H1 Z5",
        "G43.2 H1\nG43.2 Z5",
    ),
    row("I0613", "G92 needs axis words.", "G92", "G92 X0"),
    row("I0614", "This G10 is not executed.", "O1\nG10 L50\nM30", "O1\nG10 L2 P1 X10.\nM30")
        .of(crate::Dialect::Fanuc),
    row("I0615", "G10 takes L0, L1, L2, L10, L11 and L20.", "G10 L5 P1", "G10 L2 P1 X5"),
    row("I0616", "G10 needs L.", "G10 P1 X5", "G10 L2 P1 X5"),
    row("I0617", "G10 needs P, a work offset.", "G10 L2 X5", "G10 L2 P1 X5"),
    row("I0618", "G10 L20 sets no rotation.", "G10 L20 P1 X5 R30", "G10 L2 P1 X5 R30"),
    row("I0619", "G52 needs axis words.", "G52", "G52 X0"),
    row("I0620", "This G10 needs the number of a tool.", "G10 L1 Z100", "G10 L1 P1 Z100"),
    row(
        "I0621",
        "The tool table is read anew with an empty spindle.",
        "T1 M6\nG10 L0",
        "T1 M6\nT0 M6\nG10 L0",
    ),
    row("I0622", "G10 needs what it sets of a tool.", "G10 L1 P1", "G10 L1 P1 Z100"),
    row("I0640", "An output or input has a number.", "M64", "M64 P1"),
    row("I0641", "M66 reads one input.", "M66 L0", "M66 P1 L0"),
    row("I0642", "An analogue output needs its value.", "M68 E0", "M68 E0 Q2.5"),
    row("I0643", "An analogue input is read, not waited for.", "M66 E0 L3 Q5", "M66 E0"),
    row("I0644", "A wait for an input has a longest time.", "M66 P0 L3", "M66 P0 L3 Q5"),
    row(
        "I0645",
        "The machine's file does not say what this M code does.",
        "M101",
        "M0 (clamp the vice)",
    ),
    row(
        "I0646",
        "An M code of the machine builder's has no effect here: a remark where such codes are accepted. Said once for each.",
        "M31",
        "M0 (chip conveyor on)",
    )
    .of(crate::Dialect::Grbl),
    row(
        "I0647",
        "M4 of a program that was made for a laser turns a spindle counter-clockwise here.",
        "M4 S1000\nG1 X5 F500",
        "M3 S1000\nG1 X5 F500",
    )
    .of(crate::Dialect::Grbl),
    row(
        "I0648",
        "S of G4 is read as a wait in seconds.",
        "G4 S2",
        "G4 P2",
    )
    .of(crate::Dialect::Grbl),
];

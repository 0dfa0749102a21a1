//! I07 to I09: operations, limits, and what is legal but hurts.
use super::{Finding, row};

pub(super) const ROWS: &[Finding] = &[
    row(
        "I0701",
        "A move would end farther away than any machine reaches.",
        "G0 X99999999",
        "G0 X99",
    ),
    row(
        "I0702",
        "With G95 the feed follows the spindle, which does not turn.",
        "S500\nG95 F0.1\nG1 X5",
        "S500 M3\nG95 F0.1\nG1 X5",
    ),
    row(
        "I0703",
        "A tap needs a spindle speed in revolutions per minute.",
        "M3 F100\nG84 X1 Z-5 R2",
        "S100 M3 F100\nG84 X1 Z-5 R2",
    ),
    row(
        "I0704",
        "This thread is listed, and not machined.",
        "S500 M3\nG33 Z-9 K1",
        "S500 M3\nG33.1 Z-9 K1",
    ),
    row(
        "I0705",
        "A tap moves along one axis.",
        "S500 M3\nG33.1 X1 Z-9 K1",
        "S500 M3\nG0 X1\nG33.1 Z-9 K1",
    ),
    row(
        "I0706",
        "With the work turned about Z, arcs and cycles are possible in G17 only.",
        "G10 L2 P1 R30\nG18 F100\nG81 X1 Y-5 R1",
        "G10 L2 P1 R30\nG17 F100\nG81 X1 Z-5 R1",
    ),
    row("I0707", "M61 says what the spindle holds; here the tool is changed.", "M61 Q1", "T1 M6"),
    row(
        "I0708",
        "A tap needs revolutions per minute, but G96 is in force.",
        "F100 G96 S50 M3\nG84 X1 Z-5 R2",
        "F100 G97 S500 M3\nG84 X1 Z-5 R2",
    ),
    row(
        "I0709",
        "A tap has no depth.",
        "S500 M3\nG0 Z0\nG33.1 Z0 K1",
        "S500 M3\nG0 Z0\nG33.1 Z-9 K1",
    ),
    row(
        "I0712",
        "No feed is in force: the lead is that of the tap in the spindle.",
        "T2 M6\nS500 M3\nG84 X1 Z-5 R2",
        "T2 M6\nS500 M3\nG84 X1 Z-5 R2 F500",
    ),
    row(
        "I0713",
        "No probe is simulated: contact comes at the programmed end.",
        "F100\nG38.2 Z-10",
        "F100\nG1 Z-10",
    ),
    row(
        "I0714",
        "No inputs are simulated: what is waited for comes at once.",
        "M66 P0 L3 Q5",
        "G4 P5",
    ),
    row("I0715", "An output waits for a move that never comes.", "M62 P1", "M62 P1\nG0 X1"),
    row(
        "I0801",
        "Subprograms call each other too deep.",
        "o1 sub\no1 call\no1 endsub\no1 call",
        "o1 sub\nG0 X1\no1 endsub\no1 call",
    ),
    row("I0802", "There are too many named parameters.", "", ""),
    row(
        "I0803",
        "The program does not come to its end.",
        "o1 while [1]\n#1=[#1+1]\no1 endwhile",
        "o1 while [#1 LT 5]\n#1=[#1+1]\no1 endwhile",
    ),
    row(
        "I0901",
        "A subprogram is never called.",
        "o<a> sub\no<a> endsub\nG0 X1",
        "o<a> sub\no<a> endsub\no<a> call",
    ),
    row("I0902", "A parameter is read before it is set.", "G0 X#100", "#100=5\nG0 X#100"),
    row("I0903", "Nothing bounds how far the corners of a 3D program are rounded.", "", ""),
    row("I0904", "A dwell of minutes: P is in seconds.", "G4 P500", "G4 P0.5"),
    row("I0905", "The length offset is that of another tool.", "T1 M6\nG43 H2", "T1 M6\nG43 H1"),
    row("I0906", "Blocks after the end are never executed.", "M2\nG0 X1", "G0 X1\nM2"),
    row("I0907", "A tool is selected and never brought.", "T1", "T1 M6"),
    row(
        "I0908",
        "G95 has just cleared the feed, and no F follows.",
        "S500 M3 F100\nG95\nG0 X1",
        "S500 M3\nG95 F0.1\nG0 X1",
    ),
];

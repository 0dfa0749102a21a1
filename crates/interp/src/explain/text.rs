//! P: the text itself.
use crate::dialect::Dialect::Fanuc;
use crate::explain::finding::{Finding, row};

pub(super) const ROWS: &[Finding] = &[
    row("P0101", "A letter stands without its number.", "G1 X Y2 F100", "G1 X1 Y2 F100"),
    row("P0102", "This is not a number.", "G0 X1.2.3", "G0 X1.23"),
    row("P0103", "The number is too large to be computed with.", "", ""),
    row("P0104", "A character has no meaning here.", "G0 X1 ?", "G0 X1"),
    row("P0105", "A letter occurs twice in one block.", "G0 X1 X2", "G0 X1 Y2"),
    row("P0106", "The line number stands at the beginning of its line.", "G0 X1 N10", "N10 G0 X1"),
    row(
        "P0107",
        "An O-word stands at the beginning of its line.",
        "G0 X1 o1 call",
        "o1 sub\nG0 X1\no1 endsub\no1 call",
    ),
    row(
        "P0108",
        "Nothing follows an O-word in its line.",
        "o1 if [1] G0 X1\no1 endif",
        "o1 if [1]\nG0 X1\no1 endif",
    ),
    row("P0109", "The stroke of block delete stands first in its line.", "G0 /X1", "/G0 X1"),
    row("P0110", "The percent sign stands alone in its line.", "%G0 X1", "%\nG0 X1\n%"),
    row("P0111", "A comment is not closed.", "G0 X1 (to the left", "G0 X1 (to the left)"),
    row(
        "P0112",
        "A comment begins inside a comment.",
        "(drill (three) holes)",
        "(drill three holes)",
    ),
    row("P0113", "A comment is closed that was not begun.", "G0 ) X1", "G0 X1"),
    row("P0120", "A value is missing in an expression.", "G0 X[1+]", "G0 X[1+2]"),
    row(
        "P0121",
        "Two values stand beside each other without an operator.",
        "G0 X[1,2]",
        "G0 X[1+2]",
    ),
    row("P0122", "The argument of a function stands in brackets.", "G0 X SIN 30", "G0 X SIN[30]"),
    row("P0123", "No function has this name.", "G0 X[SINE[30]]", "G0 X[SIN[30]]"),
    row("P0124", "ATAN takes two values.", "G0 X ATAN[1]", "G0 X ATAN[1]/[2]"),
    row("P0125", "EXISTS asks for a parameter.", "G0 X EXISTS[5]", "G0 X EXISTS[#<depth>]"),
    row("P0126", "Brackets are nested too deep.", "", ""),
    row("P0127", "One expression has too many operations.", "", ""),
    row("P0128", "POW takes two values.", "O1\n#1=POW[2]\nM30", "O1\n#1=POW[2,3]\nM30").of(Fanuc),
    row("P0130", "The name of a parameter is not closed.", "#<depth=5", "#<depth>=5"),
    row("P0131", "A parameter has no name.", "#<>=5", "#<depth>=5"),
    row("P0132", "A name has letters, digits and underscores only.", "#<a(b>=5", "#<a_b>=5"),
    row("P0133", "A parameter that begins a word is set to something.", "#1 5", "#1=5"),
    row("P0140", "An O-word has a number or a name.", "o call", "o1 sub\no1 endsub\no1 call"),
    row("P0141", "The number of an O-word is whole.", "o1.5 call", "o1 sub\no1 endsub\no1 call"),
    row("P0142", "No O-word has this name.", "o1 loop", "o1 do\no1 while [0]"),
    row(
        "P0150",
        "Nothing follows GOTO, WHILE, DO or END in its block.",
        "O1\nGOTO 10 X1.\nN10 M30",
        "O1\nGOTO 10\nN10 M30",
    )
    .of(Fanuc),
    row(
        "P0151",
        "After IF […] comes GOTO or THEN.",
        "O1\nIF [1 EQ 1] G0 X1.\nM30",
        "O1\nIF [1 EQ 1] THEN #1=2\nM30",
    )
    .of(Fanuc),
    row(
        "P0152",
        "After WHILE […] comes DO.",
        "O1\nWHILE [1 EQ 2]\nEND1\nM30",
        "O1\nWHILE [1 EQ 2] DO1\nEND1\nM30",
    )
    .of(Fanuc),
    row(
        "P0153",
        "Loops are numbered 1 to 3.",
        "O1\nWHILE [1 EQ 2] DO4\nEND4\nM30",
        "O1\nWHILE [1 EQ 2] DO1\nEND1\nM30",
    )
    .of(Fanuc),
    row(
        "P0154",
        "After a comma comes C or R, a corner.",
        "O1\nF100\nG1 X10.,X2.\nY10.\nM30",
        "O1\nF100\nG1 X10.,C2.\nY10.\nM30",
    )
    .of(Fanuc),
    row(
        "P0155",
        "DPRNT writes text and variables with their digits.",
        "O1\nDPRNT[X#1]\nM30",
        "O1\nDPRNT[X#1[53]]\nM30",
    )
    .of(Fanuc),
    row("P0190", "A line is too long.", "", ""),
    row("P0191", "The file is no text.", "G0 X1\0 Y1", "G0 X1"),
    row("P0192", "Outside comments only plain ASCII has a meaning.", "G0 X1 é", "G0 X1 (é)"),
    row("P0193", "A line ends in the middle.", "G0 X1\rG0 X2", "G0 X1\nG0 X2"),
    row("P0194", "A comment is not UTF-8: its other characters are shown as a mark.", "", ""),
    row("P0195", "The file is larger than 4 GiB.", "", ""),
    row(
        "P0196",
        "A line is for a sender, its controller or a simulator, and is left out.",
        "$H\nG0 X1",
        "G0 X1",
    )
    .of(crate::Dialect::Grbl),
    row(
        "P0197",
        "What stands behind a semicolon is no block, and is left out.",
        "O1\nG0 X1.; up to the edge\nM30",
        "O1\nG0 X1. (up to the edge)\nM30",
    )
    .of(crate::Dialect::Fanuc),
    row(
        "P0198",
        "What stands beside the percent sign, and before the first one, is not read.",
        "%O12\nG0 X1.\nM30\n%",
        "%\nO12\nG0 X1.\nM30\n%",
    )
    .of(crate::Dialect::Fanuc),
    row("P0199", "There are more findings than are shown.", "", ""),
];

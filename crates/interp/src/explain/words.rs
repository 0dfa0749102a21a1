//! I01, I02: words and values.
use crate::explain::finding::{Finding, row};

pub(super) const ROWS: &[Finding] = &[
    row(
        "I0101",
        "A letter occurs twice in one block of a dialect whose text allows it.",
        "O1\nG0 X1. I2. I3.\nM30",
        "O1\nG0 X1.\nM30",
    )
    .of(crate::Dialect::Fanuc),
    row("I0102", "There is no G code of this number.", "G331 Z-10 K1", "S500 M3\nG33.1 Z-10 K1"),
    row("I0103", "The G code is known, and Leadscrew does not execute it.", "G17.1", "G17"),
    row("I0104", "Two G codes of one block set the same mode.", "G0 G1 X5 F100", "G1 X5 F100"),
    row("I0105", "There is no M code of this number.", "M33", "M3 S100"),
    row("I0107", "Two M codes of one block exclude each other.", "S100 M3 M4", "S100 M3"),
    row(
        "I0108",
        "A number must be whole, and within bounds.",
        "F100 S9\nG81 X1 Z-5 R2 L1.5",
        "F100 S9\nG81 X1 Z-5 R2 L1",
    ),
    row("I0109", "An axis word where no motion is in force.", "X10", "G0 X10"),
    row("I0110", "A word that no code of its block takes.", "G0 X1 Q5", "F9\nG73 X1 Z-5 R2 Q1"),
    row(
        "I0111",
        "Two codes of one block want the same axis words.",
        "G1 G92 X5 F100",
        "G92 X5\nG1 X5 F100",
    ),
    row(
        "I0112",
        "The motion of this block does not take this word.",
        "S500 M3\nG0 Z5\nG76 X3 P1 Z-9 I-1 J0.1 K0.5",
        "G18 S500 M3\nG0 Z5\nG76 P1 Z-9 I-1 J0.1 K0.5",
    ),
    row(
        "I0113",
        "A word that no code of its block takes is left out, as the dialect's controls do. Said once for each letter.",
        "O1\nT1 M6\nS500 M3\nF100.\nG81 X1. Z-5. R2. Q1.\nM30",
        "O1\nT1 M6\nS500 M3\nF100.\nG81 X1. Z-5. R2.\nM30",
    )
    .of(crate::Dialect::Fanuc),
    row(
        "I0114",
        "Two codes of one group in a block: the last acts, as Fanuc's controls have it.",
        "O1\nG0 G90 G91 X1.\nM30",
        "O1\nG0 G91 X1.\nM30",
    )
    .of(crate::Dialect::Fanuc),
    row(
        "I0115",
        "A code is executed that the controls of this dialect do not have. Said once for each code.",
        "G52 X1\nG0 X1",
        "G92 X1\nG0 X1",
    )
    .of(crate::Dialect::Grbl),
    row("I0201", "A value is not finite.", "G0 X[10**400]", "G0 X[10**2]"),
    row("I0202", "A negative number has no such power.", "G0 X[[0-8]**0.5]", "G0 X[8**0.5]"),
    row("I0203", "Something is divided by zero.", "G0 X[1/#5]", "#5=2\nG0 X[1/#5]"),
    row("I0204", "A function has no value for this.", "G0 X SQRT[-4]", "G0 X SQRT[4]"),
    row("I0205", "There is no parameter of this number.", "#9999=1", "#100=1"),
    row("I0206", "This parameter is the control's own.", "#5420=1", "#100=1"),
    row(
        "I0207",
        "A named parameter is read that has no value.",
        "G0 Z#<depth>",
        "#<depth>=-5\nG0 Z#<depth>",
    ),
];

//! I058: lathe cycles that cut a profile.
use crate::dialect::Dialect::Brother;
use crate::explain::finding::{Finding, row};

pub(super) const ROWS: &[Finding] = &[
    row(
        "I0580",
        "The cycle needs the subprogram with its profile.",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\no1 endsub\nG71 X20 Z2",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\no1 endsub\nG71 Q1 X20 Z2",
    ),
    row(
        "I0581",
        "A profile is one of X and Z.",
        "F100\no1 sub\nG0 X10 Z0\nG1 Z-10\no1 endsub\nG71 Q1 X20 Z2",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\no1 endsub\nG71 Q1 X20 Z2",
    ),
    row(
        "I0582",
        "Roughing is done without cutter compensation.",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\no1 endsub\nG42.1 D1\nG71 Q1 X20 Z2\nG40",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\no1 endsub\nG71 Q1 X20 Z2",
    ),
    row(
        "I0583",
        "The cycle's passes need a depth and a number.",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\no1 endsub\nG71 Q1 X20 Z2 I0",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\no1 endsub\nG71 Q1 X20 Z2 I1.5",
    ),
    row(
        "I0584",
        "A profile has moves.",
        "G18 F100\no1 sub\nG0 X10 Z0\no1 endsub\nG71 Q1 X20 Z2",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\no1 endsub\nG71 Q1 X20 Z2",
    ),
    row(
        "I0585",
        "A profile does not run back.",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\nX14\nZ-8\no1 endsub\nG71 Q1 X20 Z2",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\nX14\nZ-18\no1 endsub\nG71 Q1 X20 Z2",
    ),
    row(
        "I0586",
        "A fillet or chamfer fits between its moves.",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\nX14 A5\nZ-11\no1 endsub\nG71 Q1 X20 Z2",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\nX14 A0.5\nZ-11\no1 endsub\nG71 Q1 X20 Z2",
    ),
    row(
        "I0587",
        "The material left does not fit into the profile.",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\nX5\nZ-10.5\nX14\no1 endsub\nG71 Q1 X20 Z2 D1",
        "G18 F100\no1 sub\nG0 X10 Z0\nG1 Z-10\nX5\nZ-10.5\nX14\no1 endsub\nG71 Q1 X20 Z2 D0.1",
    ),
    row(
        "I0589",
        "This word has no effect in a profile.",
        "G18 F100\no1 sub\nG0 X10 Z0 M8\nG1 Z-10\no1 endsub\nG71 Q1 X20 Z2",
        "G18 F100 M8\no1 sub\nG0 X10 Z0\nG1 Z-10\no1 endsub\nG71 Q1 X20 Z2",
    ),
    row(
        "I0590",
        "Fine and back boring need Q, how far the tool moves aside.",
        "O1\nS500 M3 F100\nG0 Z5.\nG76 X1. Z-5. R1.\nM30",
        "O1\nS500 M3 F100\nG0 Z5.\nG76 X1. Z-5. R1. Q0.2\nG80\nM30",
    )
    .of(crate::Dialect::Fanuc),
    row(
        "I0591",
        "Back boring comes out to the initial level.",
        "O1\nS500 M3 F100\nG0 Z5.\nG99 G87 X1. Z-5. R-9. Q1.\nM30",
        "O1\nS500 M3 F100\nG0 Z5.\nG98 G87 X1. Z-5. R-9. Q1.\nG80\nM30",
    )
    .of(crate::Dialect::Fanuc),
    row(
        "I0592",
        "Pitch, threads per inch and speed of the way out are above 0.",
        "T2 M6\nG0 Z5\nG77 X1 Z-10 R2 I-1 S500\nG80",
        "T2 M6\nG0 Z5\nG77 X1 Z-10 R2 I1 S500\nG80",
    )
    .of(Brother),
    row(
        "I0593",
        "The pitch is given once: in mm, or as threads per inch.",
        "T2 M6\nG0 Z5\nG77 X1 Z-10 R2 I1 J20 S500\nG80",
        "T2 M6\nG0 Z5\nG77 X1 Z-10 R2 J25.4 S500\nG80",
    )
    .of(Brother),
    row(
        "I0594",
        "Synchronised tapping needs the pitch.",
        "T2 M6\nG0 Z5\nG77 X1 Z-10 R2 S500\nG80",
        "T2 M6\nG0 Z5\nG77 X1 Z-10 R2 I1 S500\nG80",
    )
    .of(Brother),
    row(
        "I0595",
        "The non-stop tool change needs the tool.",
        "G100 X10 Y10",
        "G100 T1 X10 Y10 G43 Z30 H1",
    )
    .of(Brother),
    row(
        "I0596",
        "The non-stop tool change brings the tool and moves by itself.",
        "G100 T1 M6 X10",
        "G100 T1 X10",
    )
    .of(Brother),
    row(
        "I0597",
        "A tapping cycle of Brother's turns the spindle itself, and needs its speed.",
        "T2 M6\nG0 Z5\nG84 X1 Z-10 R2 F500\nG80",
        "T2 M6\nG0 Z5\nG84 X1 Z-10 R2 F500 S500\nG80",
    )
    .of(Brother),
];

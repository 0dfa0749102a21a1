//! I10: Fanuc's dialect.
use crate::Dialect::Fanuc;
use crate::explain::finding::{Finding, row};

const fn f(
    code: &'static str,
    sentence: &'static str,
    wrong: &'static str,
    right: &'static str,
) -> Finding {
    row(code, sentence, wrong, right).of(Fanuc)
}

const fn lathe(
    code: &'static str,
    sentence: &'static str,
    wrong: &'static str,
    right: &'static str,
) -> Finding {
    row(code, sentence, wrong, right).of(crate::Dialect::FanucLatheA)
}

pub(super) const ROWS: &[Finding] = &[
    f("I1001", "O is followed by the number of a program.", "O[1+1]\nM30", "O2\nM30"),
    f(
        "I1002",
        "Loops of one level do not lie inside each other.",
        "O1\nWHILE [1 EQ 2] DO1\nWHILE [1 EQ 2] DO1\nEND1\nEND1\nM30",
        "O1\nWHILE [1 EQ 2] DO1\nWHILE [1 EQ 2] DO2\nEND2\nEND1\nM30",
    ),
    f(
        "I1003",
        "DO and END of a loop belong together.",
        "O1\nDO1\nEND2\nM30",
        "O1\nWHILE [1 EQ 2] DO1\nEND1\nM30",
    ),
    f(
        "I1004",
        "A loop is not closed.",
        "O1\nWHILE [1 EQ 2] DO1\nM30",
        "O1\nWHILE [1 EQ 2] DO1\nEND1\nM30",
    ),
    f("I1005", "The tape was not read.", "", ""),
    f(
        "I1006",
        "GOTO leads to a block of this program.",
        "O1\nGOTO 77\nM30",
        "O1\nGOTO 77\nN77 M30",
    ),
    f(
        "I1007",
        "G67 stands alone in its block.",
        "O1\nG66 P2\nG67 G0 X1.\nM30\nO2\nM99",
        "O1\nG66 P2\nG67\nM30\nO2\nM99",
    ),
    f(
        "I1008",
        "The arguments of a macro follow its G code.",
        "O1\nA1. G65 P2\nM30\nO2\nM99",
        "O1\nG65 P2 A1.\nM30\nO2\nM99",
    ),
    f(
        "I1009",
        "This letter cannot be an argument of a macro.",
        "O1\nG65 P2 G1 A1.\nM30\nO2\nM99",
        "O1\nG65 P2 A1.\nM30\nO2\nM99",
    ),
    f(
        "I1010",
        "A macro call needs P, the number of the macro.",
        "O1\nG65 A1.\nM30",
        "O1\nG65 P2 A1.\nM30\nO2\nM99",
    ),
    f("I1011", "Variables have numbers.", "O1\n#<name>=1\nM30", "O1\n#100=1\nM30"),
    f("I1012", "This variable cannot be set.", "O1\n#5021=1\nM30", "O1\n#100=1\nM30"),
    f("I1013", "This system variable is not known.", "O1\n#100=#4999\nM30", "O1\n#100=#5021\nM30"),
    f(
        "I1014",
        "AND, OR and XOR take whole numbers.",
        "O1\n#100=[1.5 AND 3]\nM30",
        "O1\n#100=[1 AND 3]\nM30",
    ),
    f(
        "I1015",
        "BIN and BCD take up to eight decimal digits.",
        "O1\n#100=BCD[-5]\nM30",
        "O1\n#100=BCD[5]\nM30",
    ),
    f("I1020", "P counts milliseconds.", "O1\nG4 P1.5\nM30", "O1\nG4 P1500\nM30"),
    f("I1021", "G54.1 takes P1 to P48.", "O1\nG54.1 P99\nM30", "O1\nG54.1 P9\nM30"),
    f(
        "I1022",
        "G10 of a tool needs R, its offset.",
        "O1\nG10 L10 P1\nM30",
        "O1\nG10 L10 P1 R100.\nM30",
    ),
    f(
        "I1023",
        "A number without a point counts thousandths.",
        "O1\nG0 X10\nM30",
        "O1\nG0 X10.\nM30",
    ),
    lathe(
        "I1030",
        "The cycle needs the numbers of its profile's blocks.",
        "O1\nG97 S500 M3\nG0 X30. Z2. F0.2\nG70 P10\nN10 G0 X10.\nN20 G1 Z-10.\nM30",
        "O1\nG97 S500 M3\nG0 X30. Z2. F0.2\nG70 P10 Q20\nG0 X50.\nM30\nN10 G0 X10.\nN20 G1 Z-10.",
    ),
    lathe(
        "I1031",
        "The cycle's lines say how deep, how far and how often.",
        "O1\nG97 S500 M3\nG0 X30. Z2.\nG71 P10 Q20 F0.2\nN10 G0 X10.\nN20 G1 Z-10.\nM30",
        "O1\nG97 S500 M3\nG0 X30. Z2.\nG71 U2. R0.5\nG71 P10 Q20 F0.2\nN10 G0 X10.\nN20 G1 Z-10.\nM30",
    ),
    lathe(
        "I1032",
        "A block of the profile is not there.",
        "O1\nG97 S500 M3\nG0 X30. Z2. F0.2\nG70 P10 Q30\nN10 G0 X10.\nN20 G1 Z-10.\nM30",
        "O1\nG97 S500 M3\nG0 X30. Z2. F0.2\nG70 P10 Q20\nM30\nN10 G0 X10.\nN20 G1 Z-10.",
    ),
    lathe(
        "I1033",
        "A profile holds no other cycle, and no call of a subprogram or macro.",
        "O1\nG97 S500 M3\nG0 X30. Z2. F0.2\nG70 P10 Q20\nM30\nN10 G0 X10.\nG71 U2. R1.\nN20 G1 Z-10.",
        "O1\nG97 S500 M3\nG0 X30. Z2. F0.2\nG70 P10 Q20\nM30\nN10 G0 X10.\nN20 G1 Z-10.",
    ),
    lathe(
        "I1034",
        "A lead that shrinks is used up before the thread ends.",
        "O1\nG97 S500 M3\nG0 X30. Z2.\nG34 Z-20. F2. K-0.5\nM30",
        "O1\nG97 S500 M3\nG0 X30. Z2.\nG34 Z-20. F2. K-0.05\nM30",
    ),
    f(
        "I1040",
        "Scaling, mirroring and rotation do not change while the cutter is beside its way.",
        "O1\nT1 M6 F100\nG41 D1 G1 X1. Y1.\nG68 X0 Y0 R5.\nM30",
        "O1\nT1 M6 F100\nG68 X0 Y0 R5.\nG41 D1 G1 X9. Y9.\nX30. Y9.\nG40 X50. Y20.\nG69\nM30",
    ),
    f(
        "I1041",
        "Mirroring is outside of scaling, and scaling outside of rotation.",
        "O1\nG68 X0 Y0 R5.\nG51 X0 Y0 P2000\nM30",
        "O1\nG51 X0 Y0 P2000\nG68 X0 Y0 R5.\nG69\nG50\nM30",
    ),
    f(
        "I1042",
        "G51 needs a factor that is not zero.",
        "O1\nG51 X0 Y0\nM30",
        "O1\nG51 X0 Y0 P2000\nG50\nM30",
    ),
    f(
        "I1043",
        "G51.1 needs the place of the mirror.",
        "O1\nG51.1\nM30",
        "O1\nG51.1 X0\nG50.1 X0\nM30",
    ),
    f("I1044", "G68 needs its angle.", "O1\nG68 X0 Y0\nM30", "O1\nG68 X0 Y0 R30.\nG69\nM30"),
    f(
        "I1045",
        "Offsets, reference points and the plane do not change in scaled, mirrored or turned coordinates.",
        "O1\nG68 X0 Y0 R30.\nG55\nM30",
        "O1\nG55\nG68 X0 Y0 R30.\nG69\nM30",
    ),
    f(
        "I1046",
        "A cycle does not drill upwards.",
        "O1\nS500 M3 F100\nG0 Z5.\nG51.1 Z0\nG81 X1. Z-5. R1.\nM30",
        "O1\nS500 M3 F100\nG0 Z5.\nG51.1 X0\nG81 X1. Z-5. R1.\nG80\nG50.1 X0\nM30",
    ),
    f(
        "I1047",
        "An arc is scaled alike along both axes of its plane.",
        "O1\nF100\nG51 X0 Y0 I2000 J1000\nG2 X10. Y0 I5.\nM30",
        "O1\nF100\nG51 X0 Y0 P2000\nG2 X10. Y0 I5.\nG50\nM30",
    ),
    f(
        "I1048",
        "The first move after G68 names one axis of two.",
        "O1\nF100\nG68 X0 Y0 R30.\nG1 X10.\nM30",
        "O1\nF100\nG68 X0 Y0 R30.\nG1 X10. Y0\nM30",
    ),
    f(
        "I1049",
        "A program's name stands behind M98, G65 or G66.",
        "O1\nG0 X1. <POCKET>\nM30\n<POCKET>\nM99",
        "O1\nM98 <POCKET>\nM30\n<POCKET>\nM99",
    ),
    f(
        "I1050",
        "M99 repeats the main program, and nothing in it ends that.",
        "O1\nG0 X1.\nM99",
        "O1\nG0 X1.\nM30",
    ),
    f(
        "I1051",
        "M99 has repeated the main program very often.",
        "O1\n#100=#100+1\nM99",
        "O1\n#100=#100+1\nIF [#100 LT 5] GOTO 9\nM30\nN9 M99",
    ),
    f(
        "I1052",
        "G30 goes to the second reference point.",
        "O1\nG30 P3 Z0\nM30",
        "O1\nG30 P2 Z0\nM30",
    ),
    f(
        "I1053",
        "G29 comes back from where G28 or G30 has gone.",
        "O1\nG29 X1.\nM30",
        "O1\nG28 X5.\nG29 X1.\nM30",
    ),
    f(
        "I1054",
        "A corner lies between two straight feeds that are long enough.",
        "O1\nF100\nG1 X10. ,R20.\nY10.\nM30",
        "O1\nF100\nG1 X10. ,R2.\nY10.\nM30",
    ),
    f(
        "I1055",
        "G27 does not lead to the reference point.",
        "O1\nG10 L2 P1 X5.\nG27 X0.\nM30",
        "O1\nG10 L2 P1 X5.\nG27 X-5.\nM30",
    ),
    f(
        "I1056",
        "G22 needs both sides of its box along each axis.",
        "O1\nG22 X100. Y100. Z0.\nM30",
        "O1\nG22 X100. Y100. Z0. I50. J50. K-100.\nM30",
    ),
    f(
        "I1057",
        "A move goes where G22 forbids it.",
        "O1\nG22 X100. Y100. Z0. I50. J50. K-100.\nG0 Z-10.\nX60. Y60.\nM30",
        "O1\nG22 X100. Y100. Z0. I50. J50. K-100.\nG0 Z10.\nX60. Y60.\nM30",
    ),
    f(
        "I1058",
        "G45 to G48 lengthen straight ways, and arcs with I and J.",
        "O1\nF100\nG91 G45 G2 X10. Y10. R10. D1\nM30",
        "O1\nF100\nG91 G45 G2 X10. Y10. J10. D1\nM30",
    ),
    lathe(
        "I1059",
        "G7.1 and G12.1 begin and end alone, where C and the plane are right.",
        "O1\nG0 X40. C10.\nG12.1\nG13.1\nM30",
        "O1\nG0 X40. C0\nG12.1\nG13.1\nM30",
    ),
    lathe(
        "I1060",
        "Only feeds, arcs and waits lie on the surface of G7.1 and G12.1.",
        "O1\nG0 X40. C0\nG12.1\nG0 X30.\nG13.1\nM30",
        "O1\nG0 X40. C0\nG98 F100\nG12.1\nG1 X30.\nG13.1\nM30",
    ),
    lathe(
        "I1061",
        "A way on a face passes the axis of C.",
        "O1\nG0 X40. C0\nG98 F100\nG12.1\nG1 X-40.\nG13.1\nM30",
        "O1\nG0 X40. C0\nG98 F100\nG12.1\nG1 C10.\nX-40.\nG13.1\nM30",
    ),
    f(
        "I1062",
        "Holes that K repeats by a radius and an angle that both grow lie on no circle.",
        "O1\nF100 S500 M3\nG16\nG99 G81 X20. Y0 Z-10. R2.\nG91 X5. Y30. K3\nM30",
        "O1\nF100 S500 M3\nG16\nG99 G81 X20. Y0 Z-10. R2.\nG91 Y30. K3\nM30",
    ),
    f(
        "I1063",
        "A round pocket needs a radius above the tool's, and K and Q together.",
        "O1\nF100\nG13 I4. D1\nM30",
        "O1\nF100\nG13 I8. D1\nM30",
    )
    .of(crate::Dialect::Haas),
    f(
        "I1064",
        "A cycle without R feeds from where the tool stands.",
        "O1\nF100 S500 M3\nG0 Z5.\nG81 X0 Z-10.\nM30",
        "O1\nF100 S500 M3\nG0 Z5.\nG81 X0 Z-10. R2.\nM30",
    )
    .of(crate::Dialect::Haas),
    f(
        "I1065",
        "P of G187 is 1, 2 or 3, and ,R of a tap 1.",
        "O1\nG187 P4\nM30",
        "O1\nG187 P3 E0.02\nM30",
    )
    .of(crate::Dialect::Haas),
    f(
        "I1066",
        "G53 has no effect while G91 is in force.",
        "O1\nG91 G53 Z0\nM30",
        "O1\nG90 G53 Z0\nM30",
    ),
    f("I1067", "A block calls one program.", "", ""),
    f(
        "I1068",
        "Numbers without a point make no sense as they are read.",
        "O1\nF100\nG0 X50 Y40 Z5\nG1 Z-5\nX100\nM30",
        "O1\nF100\nG0 X50. Y40. Z5.\nG1 Z-5.\nX100.\nM30",
    ),
    lathe(
        "I1069",
        "A line at this angle never comes to the coordinate that is named.",
        "O1\nG97 S500 M3\nG0 X20. Z2.\nG1 X40. A180. F0.2\nM30",
        "O1\nG97 S500 M3\nG0 X20. Z2.\nG1 X40. A135. F0.2\nM30",
    ),
    f(
        "I1070",
        "A work offset beyond G59 is called that was never set: its zero is the machine's.",
        "O1\nG54.1 P3\nM30",
        "O1\nG10 L20 P3 X10.\nG54.1 P3\nM30",
    ),
];

//! Whoever does not listen is told of the same places and modes as one who does.
#![allow(clippy::unwrap_used)]
use interp::{Contents, Dialect, Interpreter, Progress, Setup, Silence, example_setup};
use proptest::prelude::*;

const LINES: &[&str] = &[
    "X1 Y2",
    "X3.5 F200",
    "Y-1 Z2",
    "Z-1",
    "G1 X5",
    "G0 Y3",
    "G0",
    "G1 Y[#1*2]",
    "X#2",
    "X[1/0]",
    "G91",
    "G90 X2",
    "G91 G1 Z0.5",
    "X1 X2",
    "G0 G1 X1",
    "A5 U1",
    "F0",
    "F100",
    "F-1",
    "G20",
    "G21",
    "G93",
    "G94 F100",
    "G95 F1",
    "S300 M3",
    "M5",
    "M29",
    "G84 X1 Z-1 R2",
    "G7",
    "G8",
    "G41 D1",
    "G40",
    "G2 X3 Y2 I1 J1",
    "G3 X4 Y1 R20",
    "G81 Z-1 R2",
    "G80",
    "G98",
    "G92 X3",
    "G5.2 X1 Y1",
    "G5 X1 Y1 I1 J0 P0 Q0",
    "G33 Z-1 K1",
    "#1=5",
    "#2=[#1+1]",
    "N7 X2 Y1",
    "(note)",
    "X1 (note)",
    "/X9",
    "G53 G0 X1",
    "G28 X0",
    "G18",
    "G17",
    "M70",
    "M72",
    "T1 M6",
    "G43",
    "G10 L2 P1 X3 R10",
    "o4 call [2]",
    "X[",
];
const TAPE: &[&str] = &[
    "X1. Y2.",
    "X3.5 F200.",
    "X100",
    "Y-1. Z2.",
    "G1 X5.",
    "G0 Y3.",
    "G0",
    "G1 Y[#1*2.]",
    "X#2",
    "X#101",
    "G91",
    "G90 X2.",
    "G91 G1 Z0.5",
    "X1. X2.",
    "G0 G1 X1.",
    "F0",
    "F100",
    "F0.1",
    "G20",
    "G21",
    "G93",
    "G94 F100.",
    "G95 F1.",
    "S300 M3",
    "G41 D1",
    "G40",
    "G2 X3. Y2. I1. J1.",
    "G3 X4. Y1. R20.",
    "G3 X4. Y1. R20.5 ,C1.",
    "G1 X9. ,R1.",
    "G81 X1. Z-1. R2. K2",
    "G80",
    "G68 X0 Y0 R30.",
    "G69",
    "G51 X0 Y0 P2000",
    "G51.1 X1.",
    "G50.1 X0",
    "G50",
    "G16",
    "G15",
    "G12.1",
    "G66 P7 A1.",
    "G67",
    "G65 P7 A2.",
    "M98 P7",
    "M98 P9",
    "M98 P20007",
    "M98 P7 L2",
    "P7 M98",
    "M98 X3. P7",
    "#1=5",
    "#101=#1+1",
    "IF [#1 LT 6] THEN #1=9",
    "G18",
    "G17",
    "N7 X2. Y1.",
    "/X9.",
    "M99 P7",
    "G45 X1. D1",
    "G31 X1.",
    "G9 X2.",
    "T1 M6",
    "G43 H1",
    "G55",
    "X[",
    "",
];

fn program(menu: &'static [&'static str]) -> impl Strategy<Value = String> {
    let line = prop::sample::select(menu);
    prop::collection::vec(line, 0..60)
        .prop_map(|lines| lines.iter().fold(String::new(), |text, line| text + line + "\n"))
}

/// Both are executed in step, the silent one as an editor does: with the blocks kept that it has read.
fn stands_alike(dialect: Dialect, text: &str) {
    let mut setup = Setup { dialect, ..example_setup(dialect) };
    setup.limits.blocks = 2000;
    // as an editor does: who is silent counts an error each time it is met
    (setup.limits.errors, setup.limits.blocks_after_error) = (usize::MAX, u64::MAX);
    let mut heard = Interpreter::new(text.as_bytes(), &setup);
    let contents = Contents::default();
    let mut silent = Interpreter::new(text.as_bytes(), &setup).with_contents(contents).unheard();
    loop {
        let more = [heard.step(&mut Silence), silent.step(&mut Silence)];
        assert_eq!(heard.place(), silent.place(), "{text}");
        assert_eq!(heard.standing(), silent.standing(), "after {:?} of\n{text}", heard.place());
        assert_eq!(heard.position(), silent.position(), "{text}");
        for name in ["#1", "#5420", "#5421", "#5422", "#101"] {
            assert_eq!(heard.parameter(name), silent.parameter(name), "{name} of\n{text}");
        }
        assert_eq!(heard.has_errors(), silent.has_errors(), "{text}");
        assert_eq!(more[0], more[1], "{text}");
        if more[0] == Progress::Ended {
            return;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn lines_lead_to_the_same_places(body in program(LINES)) {
        let text = format!("o4 sub\nX#1\nG91\nY2\nG90\no4 endsub\nG21 G90 G94\nF100 G1\n{body}M2\n");
        stands_alike(Dialect::LinuxCnc, &text);
        stands_alike(Dialect::Brother, &text);
        stands_alike(Dialect::Toyoda, &text);
    }

    #[test]
    fn so_do_those_of_tapes(body in program(TAPE)) {
        let text = format!("O1\nG21 G90 G94\nF100. G1\n{body}M30\nO7\nX#1\nG91 Y2.\nG90\nM99\n");
        stands_alike(Dialect::Fanuc, &text);
        stands_alike(Dialect::FanucLatheA, &text);
    }
}

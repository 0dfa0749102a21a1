//! Outputs, inputs, the machine's own codes, and the boring cycles that stop the spindle.
use canon::{Await, OpKind, Signal};
use interp::{MachineCode, Ops, Setup, check};

fn kinds(setup: &Setup, program: &str) -> Vec<OpKind> {
    let text = format!("G21 G90 G94 F300\n{program}\nM2\n");
    let mut ops = Ops::new(text.as_bytes(), setup);
    let kinds = ops.by_ref().map(|op| op.kind).collect();
    assert!(!ops.has_errors(), "{:?}", ops.diagnostics());
    kinds
}

fn codes(program: &str) -> Vec<&'static str> {
    check(format!("{program}\nM2\n").as_bytes(), &Setup::default())
        .iter()
        .map(|finding| finding.code)
        .collect()
}

/// One letter an operation: `o` output, `r` rapid, `l` line, `e` end.
fn order(kinds: &[OpKind]) -> String {
    let letter = |kind: &OpKind| match kind {
        OpKind::Output(output) => match output.signal {
            Signal::Digital { on: true } => "on ",
            Signal::Digital { on: false } => "off ",
            Signal::Analogue { .. } => "value ",
        },
        OpKind::Rapid { .. } => "rapid ",
        OpKind::Line { .. } => "line ",
        OpKind::Input(_) => "input ",
        OpKind::Spindle { .. } => "spindle ",
        OpKind::Pause { .. } => "pause ",
        OpKind::UserCode(_) => "user ",
        OpKind::End => "end",
        _ => "",
    };
    kinds.iter().map(letter).collect()
}

#[test]
fn an_output_of_m62_waits_for_the_next_move_and_one_of_m64_does_not() {
    let setup = Setup::default();
    assert_eq!(order(&kinds(&setup, "M62 P1\nM65 P2\nG1 X1\nX2")), "off on line line spindle end");
    assert_eq!(
        order(&kinds(&setup, "M67 E0 Q2.5\nM68 E1 Q3\nG0 X1")),
        "value value rapid spindle end"
    );
}

#[test]
fn an_output_that_waits_for_a_move_that_never_comes_is_warned_about() {
    assert_eq!(codes("M62 P1"), ["I0715"]);
    assert_eq!(codes("M62 P1\nG0 X1"), [""; 0]);
}

#[test]
fn what_m66_waits_for_comes_at_once_and_is_read_back() {
    let kinds = kinds(&Setup::default(), "M66 P3 L3 Q5\nG0 X#5399\nM66 P3 L4 Q5\nG0 X[2+#5399]");
    let OpKind::Input(wait) = kinds[0] else { panic!("{kinds:?}") };
    assert_eq!((wait.number, wait.digital, wait.until), (3, true, Await::On));
    let xs: Vec<_> = kinds
        .iter()
        .filter_map(|kind| match kind {
            OpKind::Rapid { to } => Some(to.linear[0].value()),
            _ => None,
        })
        .collect();
    assert_eq!(xs, [1.0, 2.0]);
}

#[test]
fn outputs_and_inputs_want_their_numbers() {
    assert_eq!(codes("M64"), ["I0640"]);
    assert_eq!(codes("M64 P64"), ["I0108"]);
    assert_eq!(codes("M67 Q1"), ["I0640"]);
    assert_eq!(codes("M68 E1"), ["I0642"]);
    assert_eq!(codes("M66 L0"), ["I0641"]);
    assert_eq!(codes("M66 P0 E1"), ["I0641"]);
    assert_eq!(codes("M66 E0 L3 Q1"), ["I0643"]);
    assert_eq!(codes("M66 P0 L3"), ["I0644"]);
}

#[test]
fn a_code_of_the_machines_own_is_refused_unless_the_machine_names_it() {
    assert_eq!(codes("M101"), ["I0645"]);
    let clamp = MachineCode {
        number: 101,
        name: "clamp the vice".into(),
        action: interp::CodeAction::None,
    };
    let setup = Setup { user_codes: vec![clamp], ..Setup::default() };
    let kinds = kinds(&setup, "M101 P2");
    let OpKind::UserCode(code) = &kinds[0] else { panic!("{kinds:?}") };
    assert_eq!(
        (code.number, &*code.name, code.p, code.q),
        (101, "clamp the vice", Some(2.0), None)
    );
    let found = check(b"M102\nM2\n", &setup);
    assert!(found[0].help.as_ref().unwrap().contains("M101 (clamp the vice)"));
}

#[test]
fn back_boring_passes_the_bore_aside_and_cuts_upwards() {
    let program = "S500 M3\nG0 X0 Y0 Z5\nG87 X10 Z-5 R2 I1 J0 K-2";
    let kinds = kinds(&Setup::default(), program);
    let levels: Vec<_> = kinds
        .iter()
        .filter_map(|kind| match kind {
            OpKind::Line { to, .. } => Some([to.linear[0].value(), to.linear[2].value()]),
            _ => None,
        })
        .collect();
    assert_eq!(levels, [[10.0, -2.0], [10.0, -5.0]], "cuts on the axis of the bore only");
    assert_eq!(codes("F9 S500 M3\nG0 Z5\nG87 X1 Z-5 R2 I1 J0 K-6"), ["I0519"]);
    assert_eq!(codes("F9 S500 M3\nG0 Z5\nG87 X1 Z-5 R2 I1 J0"), ["I0518"]);
}

#[test]
fn boring_out_by_hand_stops_and_is_out_before_the_spindle_turns_again() {
    let kinds = kinds(&Setup::default(), "S500 M3\nG0 Z5\nG88 X10 Z-5 R2 P1");
    assert!(
        order(&kinds).ends_with("line spindle pause rapid spindle spindle end"),
        "{}",
        order(&kinds)
    );
}

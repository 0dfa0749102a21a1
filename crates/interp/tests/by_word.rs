//! M, G and T that call programs, as a machine's file has set them: Fanuc's parameters 6050 to
//! 6059, 6071 to 6089 and 6001#5.
use canon::OpKind;
use interp::{CodeAction, Dialect, MachineCode, MacroCall, MissingTools, Ops, Setup};

/// M31 and G101 take arguments, M32 and T call as M98 does, M6 is a macro that changes the tool
/// itself.
fn setup(dialect: Dialect) -> Setup {
    let call = |letter, number, program, takes_arguments| MacroCall {
        letter,
        number,
        program,
        takes_arguments,
    };
    let name = |number| MachineCode { number, name: "chips".into(), action: CodeAction::None };
    Setup {
        dialect,
        missing_tools: MissingTools::StandIn,
        macro_calls: vec![
            call('M', Some(31), 9020, true),
            call('M', Some(32), 9001, false),
            call('M', Some(6), 9021, true),
            call('G', Some(101), 9010, true),
            call('T', None, 9000, false),
        ],
        user_codes: vec![name(31), name(32)],
        ..Setup::default()
    }
}

/// X and Y of its moves, "change" for a tool change, "M31" for the builder's code, and the codes of
/// its findings.
fn told_in(program: &str, dialect: Dialect) -> Vec<String> {
    let setup = setup(dialect);
    let mut ops = Ops::new(program.as_bytes(), &setup);
    let mut said: Vec<_> = ops
        .by_ref()
        .filter_map(|op| match op.kind {
            OpKind::Rapid { to } => {
                Some(format!("{} {}", to.linear[0].value(), to.linear[1].value()))
            }
            OpKind::ChangeTool { .. } => Some("change".to_owned()),
            OpKind::UserCode(code) => Some(format!("M{}", code.number)),
            _ => None,
        })
        .collect();
    let errors = ops.diagnostics().into_iter().filter(diag::Diagnostic::is_error);
    said.extend(errors.map(|finding| finding.code.to_owned()));
    said
}

fn told(program: &str) -> Vec<String> {
    told_in(program, Dialect::Fanuc)
}

#[test]
fn an_m_code_with_arguments_is_a_macro_call() {
    let program = "O1\nM31 A1. B2. L2\nG0 X9.\nM30\nO9020\nG91 G0 X#1 Y#2\nG90\nM99\n";
    assert_eq!(told(program), ["1 2", "2 4", "9 4"]);
}

#[test]
fn a_g_code_is_a_macro_call_too() {
    let program = "O1\nG101 X5. Y-1.\nM30\nO9010\nG0 X#24 Y#25\nM99\n";
    assert_eq!(told(program), ["5 -1"]);
}

#[test]
fn an_m_code_without_arguments_comes_after_what_else_the_block_says() {
    let program = "O1\n#1=7.\nG0 X1. M32\nM30\nO9001\nG0 Y#1\nM99\n";
    assert_eq!(told(program), ["1 0", "1 7"], "it has the variables of its caller");
}

#[test]
fn t_leaves_its_number_in_149() {
    assert_eq!(told("O1\nT5\nM30\nO9000\nG0 X#149\nM99\n"), ["5 0"]);
}

#[test]
fn in_the_macro_and_below_the_word_is_the_plain_one() {
    let changes = "O1\nM6 T5\nM30\nO9021\nM98 P8\nM99\nO8\nT#20 M6\nM99\n";
    assert_eq!(told(changes), ["change"]);
    let itself = "O1\nM31\nM30\nO9020\nG0 X1.\nM31\nM32\nM99\n";
    assert_eq!(told(itself), ["1 0", "M31", "M32"]);
    // and afterwards it calls again
    let twice = "O1\nM31\nM31\nM30\nO9020\nG91 G0 X1.\nG90\nM99\n";
    assert_eq!(told(twice), ["1 0", "2 0"]);
}

#[test]
fn what_cannot_be_called_so_is_said() {
    assert_eq!(told("O1\nM31\nM30\n"), ["I0313"], "O9020 is not there");
    assert_eq!(told("O1\nA1. M31\nM30\nO9020\nM99\n"), ["I1008"], "arguments stand behind it");
    assert_eq!(told("O1\nM31 P2\nM30\nO9020\nM99\n"), ["I1009"], "P is no argument");
    assert_eq!(told("O1\nM32 M98 P2\nM30\nO2\nM99\nO9001\nM99\n"), ["I1067"], "one call a block");
    assert_eq!(told_in("G21\nM31\nM2\n", Dialect::LinuxCnc), ["I0645"]);
}

#[test]
fn files_that_words_call_are_looked_for() {
    let setup = setup(Dialect::Fanuc);
    let called = |text: &str| {
        interp::files_called_by_word(text.as_bytes(), &setup.macro_calls, gcode::Grammar::Fanuc)
    };
    assert_eq!(called("O1\nG0 X1. M32\nT3\nM98 P7\nM30\n"), ["9001", "9000"]);
}

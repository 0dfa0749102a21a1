//! Fanuc's checks of where the axes go (G22, G27), ways that an offset makes longer (G45 to G48),
//! programs in files (M198), and lathes of system C: what the manual's rules come to by hand.
use canon::{OpKind, Tool, ToolKind, ToolLibrary};
use interp::{Call, Dialect, Interpreter, Ops, Parameters, Place, Setup, Sink, Subprogram};

fn setup() -> Setup {
    let tool = Tool {
        number: 1,
        pocket: 1,
        length: units::Length::mm(100.0),
        diameter: units::Length::mm(20.0),
        kind: ToolKind::EndMill(canon::Mill::default()),
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    };
    Setup { dialect: Dialect::Fanuc, tools: ToolLibrary::new([tool]), ..Setup::default() }
}

fn ends_of(program: &str, setup: &Setup) -> (Vec<[f64; 3]>, Vec<String>) {
    let text = format!("O1\n{program}\nM30\n");
    let mut ops = Ops::new(text.as_bytes(), setup);
    let ends = ops.by_ref().filter_map(|op| match op.kind {
        OpKind::Rapid { to } | OpKind::Line { to, .. } | OpKind::Arc { to, .. } => {
            Some(to.linear.map(units::Length::value))
        }
        _ => None,
    });
    let ends = ends.collect();
    let told = |d: &diag::Diagnostic| {
        format!("{}@{} {} {}", d.code, d.span.line, d.message, d.help.as_deref().unwrap_or(""))
    };
    (ends, ops.diagnostics().iter().map(told).collect())
}

#[track_caller]
fn goes_to(program: &str, setup: &Setup, wanted: &[[f64; 3]]) {
    let (found, told) = ends_of(program, setup);
    assert!(told.is_empty(), "{told:#?}");
    let near = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
    let same = found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| near(a, b));
    assert!(same, "found {found:?}, wanted {wanted:?}");
}

#[track_caller]
fn is_told(program: &str, setup: &Setup, wanted: &[&str]) {
    let (_, told) = ends_of(program, setup);
    let all = |told: &String| wanted.iter().all(|wanted| told.contains(wanted));
    assert!(told.iter().any(all), "{wanted:?} is not in {told:#?}");
}

/// The reference point at X-10 Y-20 Z150 of the machine.
fn with_reference() -> Setup {
    let mut parameters = Parameters::default();
    for (number, value) in [(5161, -10.0), (5162, -20.0), (5163, 150.0)] {
        assert!(parameters.set(number, value));
    }
    Setup { parameters, ..setup() }
}

#[test]
fn g27_goes_there_and_asks_whether_it_is_the_reference_point() {
    let setup = with_reference();
    goes_to("G27 X-10. Y-20.\nG1 F100. X0.", &setup, &[[-10.0, -20.0, 0.0], [0.0, -20.0, 0.0]]);
    // of the axes that are named, in the work's coordinates, by G91 too
    goes_to("G92 X1. Y2. Z3.\nG91 G27 Z150.", &setup, &[[0.0, 0.0, 150.0]]);
    goes_to("G20 G27 Z5.9055", &setup, &[[0.0, 0.0, 149.9997]]); // within half an increment
    let moved = "G10 L2 P1 X30.\nG27 X-10. Y-20.";
    is_told(
        moved,
        &setup,
        &["I1055@3", "G27 leads to X20 of the machine", "is at X-10", "X-40 here"],
    );
    // a tool's length counts
    is_told("G43 H1 Z200.\nG27 Z150.", &setup, &["I1055@3", "Z250", "at Z150", "Z50 here"]);
    is_told("G27", &setup, &["I1055@2", "needs axis words"]);
    // the motion in force goes on
    goes_to(
        "G1 F100. X-5.\nG27 X-10.\nX0.\nG0",
        &setup,
        &[[-5.0, 0.0, 0.0], [-10.0, 0.0, 0.0], [0.0; 3]],
    );
}

#[test]
fn no_move_enters_the_box_of_g22_and_behind_g23_all_may() {
    let zone = "G22 X10. Y10. Z0. I0. J0. K-10.\n";
    let program = |moves: &str| format!("G0 X-20. Y5. Z5.\n{zone}{moves}");
    // over it, then straight down into it: it may go to its lid
    is_told(
        &program("G0 X5.\nZ-1."),
        &setup(),
        &[
            "I1057@5",
            "enters the box that G22 forbids",
            "X 0 to 10, Y 0 to 10, Z -10 to 0",
            "X5 Y5 Z0",
        ],
    );
    // along its side, over its lid, through it
    goes_to(
        &program("G0 X0. Z0.\nG1 F100. Z-5."),
        &setup(),
        &[[-20.0, 5.0, 5.0], [0.0, 5.0, 0.0], [0.0, 5.0, -5.0]],
    );
    is_told(&program("G0 Z-5.\nG1 F100. X20."), &setup(), &["I1057@5", "X0 Y5 Z-5"]);
    // an arc whose ends are outside: about X-8 Y5, radius 10, it bulges to X2 and comes to Y0
    // at -8 + √75
    let arc = "G0 X-8. Y-5. Z-5.\nG3 F100. X-8. Y15. J10.";
    is_told(&program(arc), &setup(), &["I1057@5", "X0.66 Y0 Z-5"]);
    goes_to(&program("G23\nG0 X5. Z-1."), &setup(), &[[-20.0, 5.0, 5.0], [5.0, 5.0, -1.0]]);
    // G22 alone brings it back; a hole and a tap enter it too
    is_told(&program("G23\nG22\nG99 G81 X5. Z-5. R2. F100."), &setup(), &["I1057@6", "X5 Y5 Z0"]);
    is_told(&program("M29 S500\nG99 G84 X5. Z-5. R2. F500."), &setup(), &["I1057@5", "X5 Y5 Z0"]);
    // it is the machine's: offsets do not move it
    is_told(&format!("G10 L2 P1 Z-20.\nG0 Z30.\n{zone}G0 X5. Y5. Z15."), &setup(), &["I1057@5"]);
}

#[test]
fn the_outside_is_forbidden_where_the_machine_has_it_so() {
    let setup = Setup { stroke_check_outside: true, ..setup() };
    let zone = "G22 X50. Y50. Z50. I-50. J-50. K-50.\n";
    goes_to(&format!("{zone}G0 X50. Y-50."), &setup, &[[50.0, -50.0, 0.0]]);
    is_told(
        &format!("{zone}G0 X100. Y20."),
        &setup,
        &["I1057@3", "leaves the box that G22 allows", "X50 Y10 Z0"],
    );
}

#[test]
fn a_lathes_box_has_diameters() {
    let setup = Setup { dialect: Dialect::FanucLatheA, ..setup() };
    // Ø40 is 20 from the axis
    let program = "G0 X100. Z20.\nG22 X40. Z0. I-40. K-100.\nX40. Z-10.\nX39. Z-20.";
    is_told(program, &setup, &["I1057@5", "X -20 to 20, Z -100 to 0", "X20"]);
    is_told("G22 X40. I-40.", &setup, &["I1056@2", "X, Z, I and K"]);
    is_told("G22 X-40. I40. Z0. K-100.", &setup, &["I1056@2", "X above I"]);
    is_told("G22", &setup, &["I1056@2"]);
}

#[test]
fn ways_are_longer_or_shorter_by_an_offset_as_in_the_manuals_example() {
    // a tool of radius 10 round a figure; it ends where it began
    let program = "N1 G91 G46 G0 X80. Y50. D1\nN2 G47 G1 X50. F120.\nN3 Y40.\nN4 G48 X40.\nN5 Y-40.\n\
        N6 G45 X30.\nN7 G45 G3 X30. Y30. J30.\nN8 G45 G1 Y20.\nN9 G46 X0.\nN10 G46 G2 X-30. Y30. J30.\n\
        N11 G45 G1 Y0.\nN12 G47 X-120.\nN13 G47 Y-80.\nN14 G46 G0 X-80. Y-50.";
    let flat = [
        [70.0, 40.0],
        [140.0, 40.0],
        [140.0, 80.0],
        [160.0, 80.0],
        [160.0, 40.0],
        [200.0, 40.0],
        [240.0, 80.0],
        [240.0, 110.0],
        [230.0, 110.0],
        [210.0, 130.0],
        [210.0, 140.0],
        [70.0, 140.0],
        [70.0, 40.0],
        [0.0, 0.0],
    ];
    goes_to(program, &setup(), &flat.map(|[x, y]| [x, y, 0.0]));
}

#[test]
fn an_increment_of_nothing_has_a_sign_and_an_absolute_way_its_direction() {
    goes_to(
        "G91 G0 G45 X0. D1\nG45 X-0.\nG46 X-0.",
        &setup(),
        &[[10.0, 0.0, 0.0], [0.0; 3], [10.0, 0.0, 0.0]],
    );
    // from 0 to 30 is +30, then back to 10 is −20; where it stands already is no way
    goes_to("G90 G0 G45 X30. D1\nG45 X10.\nG45 X0. Y0.", &setup(), &[[40.0, 0.0, 0.0], [0.0; 3]]);
    // shorter than the offset: it goes the other way
    goes_to("G91 G0 G46 X4. D1", &setup(), &[[-6.0, 0.0, 0.0]]);
    is_told("G91 G1 F100. X50.\nG45 G2 X10. Y10. R10. D1", &setup(), &["I1058@3", "R"]);
    is_told("G81 Z-5. R2. F100.\nG45 X10. D1", &setup(), &["I1058@3"]);
}

#[test]
fn m198_calls_a_file_and_m98_what_is_on_the_tape() {
    let file = |name: &str, source: &str| Subprogram { name: name.into(), source: source.into() };
    let files = vec![file("7", "O7\nG0 Y1.\nM99\n"), file("8", "G91 G0 Z1.\nG90\nM99\n")];
    let setup = Setup { subprograms: files, ..setup() };
    let tape = |calls: &str| format!("{calls}\nM30\nO7\nG0 X1.\nM99");
    goes_to(&tape("M98 P7\nM198 P7"), &setup, &[[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    goes_to(&tape("M198 P8 L2"), &setup, &[[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]]);
    goes_to(&tape("M198 P20008"), &setup, &[[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]]);
    is_told(&tape("M198 P9"), &setup, &["I0313@2", "no file O9.nc"]);
    is_told(
        "M198 P7\nM30\nO7\nM99",
        &Setup { subprograms: Vec::new(), ..setup.clone() },
        &["I0313@2", "M98 calls it"],
    );
    is_told("M198", &setup, &["I0302@2", "M198 needs P"]);
    let called = |text: &str| interp::called_files(text.as_bytes(), gcode::Grammar::Fanuc);
    assert_eq!(called("O1\nM98P7\nM198P7\nM30\nO7\nM99\n"), ["7"]);
    assert_eq!(called("O1\nM98P7\nM30\nO7\nM99\n"), [""; 0]);
}

/// Calls that move or set a mode, in a few letters.
#[derive(Default)]
struct Heard(Vec<String>);

impl Sink for Heard {
    fn call(&mut self, _: &Place, call: &Call<'_>) {
        self.0.extend(match call {
            Call::Rapid(to) => Some(format!("R {:.3} {:.3}", to[0], to[2])),
            Call::Line(to) => Some(format!("F {:.3} {:.3}", to[0], to[2])),
            Call::SyncStart(lead) => Some(format!("@ {lead:.3}")),
            Call::UseUnits(units) => Some(format!("{units:?}")),
            Call::FeedRate { rate, .. } if *rate > 0.0 => Some(format!("f {rate:.3}")),
            Call::SpindleMode(limit) if *limit > 0.0 => Some(format!("S {limit}")),
            Call::AddedOffset(by) => Some(format!("+ {:.3} {:.3}", by[0], by[2])),
            _ => None,
        });
    }
}

fn heard(dialect: Dialect, program: &str) -> (Vec<String>, Vec<String>) {
    let setup = Setup { dialect, ..setup() };
    let text = format!("O1\nG97 S500 M3\n{program}\nM30\n");
    let mut interpreter = Interpreter::new(text.as_bytes(), &setup);
    let mut heard = Heard::default();
    interpreter.run(&mut heard);
    let told = |d: &diag::Diagnostic| format!("{}@{} {}", d.code, d.span.line, d.message);
    (heard.0, interpreter.diagnostics().iter().map(told).collect())
}

#[test]
fn system_c_writes_the_same_lathe_with_other_numbers() {
    let pairs = [
        (
            "G0 X50. Z2.\nG77 X40. Z-20. F0.2\nX36.\nG0 X60.",
            "G0 X50. Z2.\nG20 X40. Z-20. F0.2\nX36.\nG0 X60.",
        ),
        ("G0 X50. Z2.\nG78 X40. Z-20. F1.5", "G0 X50. Z2.\nG21 X40. Z-20. F1.5"),
        ("G0 X50. Z2.\nG79 X40. Z-2. F0.2", "G0 X50. Z2.\nG24 X40. Z-2. F0.2"),
        ("G20 G0 X1. Z1.\nG21 X1.", "G70 G0 X1. Z1.\nG71 X1."),
        ("G33 Z-20. F1.5", "G33 Z-20. F1.5"),
        ("G94 G1 X10. F100.\nG91 X2.\nG90 X2.", "G94 G1 X10. F100.\nG91 X2.\nG90 X2."),
        ("G92 S2000\nG92 X20. Z0.\nG96 S100", "G92 S2000\nG92 X20. Z0.\nG96 S100"),
        (
            "G0 X30. Z2.\nG71 U4. R1.\nG71 P10 Q20 U0.4 W0.1 F0.3\nN10 G0 X10.\nG1 Z-10. F0.1\nN20 X30.\nG70 P10 Q20",
            "G0 X30. Z2.\nG73 U4. R1.\nG73 P10 Q20 U0.4 W0.1 F0.3\nN10 G0 X10.\nG1 Z-10. F0.1\nN20 X30.\nG72 P10 Q20",
        ),
        ("G0 X20. Z2.\nG74 R1.\nG74 Z-5. Q4000 F0.2", "G0 X20. Z2.\nG76 R1.\nG76 Z-5. Q4000 F0.2"),
        (
            "G0 X22. Z5.\nG76 P010060 Q100 R0.05\nG76 X18. Z-20. P1000 Q400 F1.5",
            "G0 X22. Z5.\nG78 P010060 Q100 R0.05\nG78 X18. Z-20. P1000 Q400 F1.5",
        ),
    ];
    for (b, c) in pairs {
        let (wanted, refused) = heard(Dialect::FanucLatheB, b);
        assert!(refused.is_empty() && wanted.len() > 2, "{refused:#?}");
        assert_eq!(heard(Dialect::FanucLatheC, c), (wanted, Vec::new()), "{c}");
    }
    // variables tell the codes as this machine writes them
    let modal = "G0 X50. Z2.\nG20 X40. Z-20. F0.2\nG0 X[#4001+100.*#4006] Z0.";
    let (_, told) = heard(Dialect::FanucLatheC, modal);
    assert!(told.is_empty(), "{told:?}");
    // and sentences name them
    let (_, told) = heard(Dialect::FanucLatheC, "G73 P10 Q20 F0.2\nN10 G0 X10.\nN20 Z0.");
    assert!(told[0].contains("G73 does not know how deep a pass is"), "{told:?}");
    let (_, told) = heard(Dialect::FanucLatheC, "G78 X10. Z-5. P1000 Q300 F1.5");
    assert!(told[0].contains("G78 does not know its passes"), "{told:?}");
    let (_, told) = heard(Dialect::FanucLatheC, "G79 X10.");
    assert!(told[0].starts_with("I0102"), "{told:?}");
}

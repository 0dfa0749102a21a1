//! Fanuc's G7.1 and G12.1: where a linear axis and a turning one go together, and how long they
//! take, by trigonometry.
use canon::{Feed, OpKind};
use core::f64::consts::PI;
use interp::{Dialect, Ops, Setup};

/// X, Y, Z, C in mm and degrees, and the seconds that a feed has.
type Step = ([f64; 4], Option<f64>);

fn run(dialect: Dialect, program: &str) -> (Vec<Step>, Vec<String>) {
    let tool = canon::Tool {
        number: 1,
        pocket: 1,
        length: units::Length::ZERO,
        diameter: units::Length::mm(8.0),
        kind: canon::ToolKind::EndMill(canon::Mill::default()),
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    };
    let tools = canon::ToolLibrary::new([tool]);
    let setup = Setup { dialect, tools, ..Setup::default() };
    let text = format!("O1\nG97 S1000 M3\n{program}\nM30\n");
    let mut ops = Ops::new(text.as_bytes(), &setup);
    let place = |to: &canon::Position| {
        let [x, y, z] = to.linear.map(units::Length::value);
        [x, y, z, to.rotary[2].in_deg()]
    };
    let steps = ops.by_ref().filter_map(|op| match op.kind {
        OpKind::Rapid { to } => Some((place(&to), None)),
        OpKind::Line { to, feed: Feed::Duration(time) } => Some((place(&to), Some(time.value()))),
        OpKind::Line { to, .. } => Some((place(&to), Some(f64::NAN))),
        OpKind::Arc { .. } => panic!("no arc is left"),
        _ => None,
    });
    let steps = steps.collect();
    let told = |d: &diag::Diagnostic| {
        format!("{}@{} {} {}", d.code, d.span.line, d.message, d.help.as_deref().unwrap_or(""))
    };
    (steps, ops.diagnostics().iter().map(told).collect())
}

#[track_caller]
fn steps_of(dialect: Dialect, program: &str) -> Vec<Step> {
    let (steps, told) = run(dialect, program);
    assert!(told.is_empty(), "{told:#?}");
    steps
}

#[track_caller]
fn near(found: &Step, at: [f64; 4], seconds: f64) {
    let same = found.0.iter().zip(at).all(|(a, b)| (a - b).abs() < 1e-9);
    let time = found.1.is_some_and(|found| (found - seconds).abs() < 1e-9);
    assert!(same && time, "found {found:?}, wanted {at:?} in {seconds} s");
}

#[track_caller]
fn is_told(dialect: Dialect, program: &str, wanted: &[&str]) {
    let (_, told) = run(dialect, program);
    let all = |told: &String| wanted.iter().all(|wanted| told.contains(wanted));
    assert!(told.iter().any(all), "{wanted:?} is not in {told:#?}");
}

const LATHE: Dialect = Dialect::FanucLatheB;
/// Radius of which a degree is a millimetre of the circumference.
const ONE: f64 = 180.0 / PI;
/// Before a program on a cylinder of that radius, at X114.592 (Ø), Z0, C0.
const CYLINDER: &str = "G0 X114.592 Z0 C0\nG94 G18 F120\nG7.1 C57.29578\n";

#[test]
fn a_line_round_a_cylinder_is_a_line_of_its_axes_in_the_time_of_the_surface() {
    // 30 along Z and 40 round: 50 mm at 120 mm/min; then by increments, then into the work
    let program = format!("{CYLINDER}G1 Z30. C40.\nW-30. H-40.\nX104.592\nG7.1 C0\nG0 X200.");
    let steps = steps_of(LATHE, &program);
    assert_eq!(steps.len(), 5);
    let x = 114.592 / 2.0;
    let small = 1e-6; // 57.29578 is not quite 180/π
    let close = |a: f64, b: f64| (a - b).abs() < small;
    assert!(steps[1].0[..3] == [x, 0.0, 30.0] && close(steps[1].0[3], 40.0), "{steps:?}");
    assert!(close(steps[1].1.unwrap(), 25.0) && close(steps[2].1.unwrap(), 25.0), "{steps:?}");
    assert!(close(steps[2].0[2], 0.0) && close(steps[2].0[3], 0.0), "{steps:?}");
    near(&steps[3], [52.296, 0.0, 0.0, steps[2].0[3]], 2.5);
    assert_eq!(steps[4].0[0], 100.0);
}

#[test]
fn an_arc_round_a_cylinder_is_nowhere_farther_from_it_than_half_a_micrometre() {
    // a half circle of radius 10 about Z10 C0 in the unrolled plane, counter-clockwise from Z20
    // over C10 to Z0
    let program = format!("{CYLINDER}G1 Z20. C0\nG3 Z0 C0 R10.\nG7.1 C0");
    let steps = steps_of(LATHE, &program);
    let (mut from, mut seconds, mut highest) = ([20.0, 0.0], 0.0, 0.0_f64);
    for (at, time) in &steps[2..] {
        let to = [at[2], at[3].to_radians() * ONE];
        let middle = [f64::midpoint(from[0], to[0]), f64::midpoint(from[1], to[1])];
        for point in [middle, to] {
            let radius = (point[0] - 10.0).hypot(point[1]);
            assert!((radius - 10.0).abs() < 0.000_5, "{radius}");
        }
        (from, highest) = (to, highest.max(to[1]));
        seconds += time.unwrap();
    }
    // C rises: in G18, with C in the place of X, counter-clockwise goes from Z to X
    assert!((highest - 10.0).abs() < 0.001 && from[0].abs() < 1e-9, "{highest} {from:?}");
    assert!((seconds - 10.0 * PI / 2.0).abs() < 1e-3, "{seconds} s of 10·π mm at 120 mm/min");
}

#[test]
fn compensation_lies_in_the_unrolled_plane() {
    // a groove's wall along C at Z50, the tool of radius 4 to the right of it (towards +Z, for C
    // goes up)
    let program = format!("G0 C-30.\n{CYLINDER}G1 C-30.\nG42 D1 Z50. C0\nC40.\nG40 Z100.\nG7.1 C0");
    let steps = steps_of(LATHE, &program);
    let along: Vec<_> = steps.iter().filter(|(at, _)| (at[2] - 54.0).abs() < 1e-6).collect();
    assert!(!along.is_empty(), "{steps:?}");
    let last = along.last().unwrap();
    assert!((last.0[3] - 40.0).abs() < 1e-5, "{steps:?}");
}

#[test]
fn a_machining_centre_unrolls_about_its_a_axis() {
    // the axis X, tool along Z: in G17 A stands in the place of Y
    let ops_of = |program: &str| {
        let setup = Setup { dialect: Dialect::Fanuc, ..Setup::default() };
        let text = format!("O1\nG17 G90 G94 F600\n{program}\nM30\n");
        let mut ops = Ops::new(text.as_bytes(), &setup);
        let lines: Vec<_> = ops
            .by_ref()
            .filter_map(|op| match op.kind {
                OpKind::Line { to, feed: Feed::Duration(time) } => Some((to, time.value())),
                _ => None,
            })
            .collect();
        assert!(!ops.has_errors(), "{:?}", ops.diagnostics());
        lines
    };
    let lines = ops_of("G7.1 A20.\nG1 X10. A90. Z-1.\nG91 A-90.\nG7.1 A0");
    let round = 20.0 * PI / 2.0;
    let (to, seconds) = lines[0];
    assert!((to.rotary[0].in_deg() - 90.0).abs() < 1e-9 && to.linear[1].value() == 0.0);
    assert!((seconds - (100.0 + round * round + 1.0_f64).sqrt() / 10.0).abs() < 1e-9);
    assert!(lines[1].0.rotary[0].in_deg().abs() < 1e-9 && (lines[1].1 - round / 10.0).abs() < 1e-9);
}

#[test]
fn a_square_on_a_face_is_straight_within_half_a_micrometre() {
    // 40 x 40 about the axis, from X20 C0 round and back: C has turned once
    let program = "G0 X40. Z0 C0\nG94 F100\nG12.1\nG1 C20.\nX-40.\nC-20.\nX40.\nC0\nG13.1\nG0 X60.";
    let steps = steps_of(LATHE, program);
    let flat = |at: &[f64; 4]| {
        let (sin, cos) = at[3].to_radians().sin_cos();
        [at[0] * cos, at[0] * sin]
    };
    let (mut seconds, mut from) = (0.0, steps[0].0);
    let body = &steps[1..steps.len() - 1];
    for (at, time) in body {
        for part in [0.25, 0.5, 0.75, 1.0] {
            let now: [f64; 4] = core::array::from_fn(|i| from[i] + part * (at[i] - from[i]));
            let [x, y] = flat(&now);
            assert!((x.abs().max(y.abs()) - 20.0).abs() < 0.000_5, "{x} {y}");
        }
        seconds += time.unwrap();
        from = *at;
    }
    let last = body.last().unwrap().0;
    assert!((last[3] - 360.0).abs() < 1e-9 && (last[0] - 20.0).abs() < 1e-9, "{last:?}");
    assert!((seconds - 160.0 * 0.6).abs() < 1e-9, "{seconds} s for 160 mm at 100 mm/min");
    // C goes on from where it is
    assert!((steps.last().unwrap().0[3] - 360.0).abs() < 1e-9);
}

#[test]
fn a_circle_on_a_face_about_its_axis_turns_c_alone() {
    let program = "G0 X40. Z0 C0\nG94 F100\nG12.1\nG3 X40. C0 I-20. J0\nG1 Z-1.\nG13.1";
    let steps = steps_of(LATHE, program);
    for (at, _) in &steps[1..] {
        assert!((at[0] - 20.0).abs() < 0.000_5, "{at:?}");
    }
    let last = steps.last().unwrap();
    near(last, [20.0, 0.0, -1.0, 360.0], 0.6);
    // half of it by R, the other way
    let half = steps_of(LATHE, "G0 X40. C0\nG94 F100\nG12.1\nG2 X-40. C0 R20.\nG13.1");
    assert!((half.last().unwrap().0[3] + 180.0).abs() < 1e-9);
}

#[test]
fn what_does_not_lie_on_the_surface_is_refused_in_one_sentence() {
    let face = |block: &str| format!("G0 X40. Z0 C0\nG94 F100\nG12.1\n{block}");
    is_told(LATHE, &face("G0 X50."), &["I1060@6 G0 cannot be used while G12.1", "G13.1 ends it"]);
    is_told(LATHE, &face("G28 U0"), &["I1060@6 G28"]);
    is_told(LATHE, &face("X50."), &["I1060@6 a rapid move"]);
    is_told(LATHE, &face("G1 X-40. C0"), &["I1061@6", "passes the axis of C"]);
    is_told(LATHE, &face("G7.1 C20."), &["I1059@6", "G12.1 is in force"]);
    is_told(LATHE, "G0 X40. C10.\nG12.1", &["I1059@4", "C10", "G0 X50. C0"]);
    is_told(LATHE, "G0 X40. C0\nG12.1 X30.", &["I1059@4", "alone"]);
    let round = |block: &str| format!("{CYLINDER}{block}");
    is_told(LATHE, &round("G3 Z10. C10. K5. I0"), &["I1060@6", "by R", "G7.1 C0 ends it"]);
    is_told(LATHE, &round("G1 Z10. ,R2.\nC10."), &["I1060@6 ,R"]);
    is_told(LATHE, &round("G1 G42 D1 Z10.\nG7.1 C0"), &["I1059@7", "write G40"]);
    is_told(LATHE, "G17\nG7.1 C20.", &["I1059@4", "G18 or G19"]);
    is_told(LATHE, "G18\nG7.1 C-20.", &["I1059@4", "above 0"]);
    is_told(LATHE, "G7.1", &["I1059@3", "G7.1 C20."]);
    let no_c = Setup { dialect: LATHE, c_is_a_chamfer: true, ..Setup::default() };
    for start in ["G12.1", "G7.1 C20."] {
        let program = format!("O1\nG0 X40.\n{start}\nM30\n");
        let found = interp::check(program.as_bytes(), &no_c);
        assert!(found.iter().any(|d| d.message.contains("has no C axis")), "{found:?}");
    }
}

//! Fanuc's polar coordinates, scaling, rotation and mirroring, by the arithmetic of its manual;
//! boring with the tool moved aside.
use canon::{OpKind, SpindleOrder};
use interp::{Aside, Cycles, Dialect, MissingTools, Ops, Setup};

fn setup() -> Setup {
    Setup { dialect: Dialect::Fanuc, missing_tools: MissingTools::StandIn, ..Setup::default() }
}

fn ops_with(program: &str, setup: &Setup) -> (Vec<OpKind>, Vec<String>) {
    let text = format!("O1\nG21 G90 G94 F100\n{program}\nM30\n");
    let mut ops = Ops::new(text.as_bytes(), setup);
    let kinds = ops.by_ref().map(|op| op.kind).collect();
    let findings = ops.diagnostics().iter().map(|d| format!("{} {}", d.code, d.message)).collect();
    (kinds, findings)
}

fn ends(kinds: &[OpKind]) -> Vec<[f64; 3]> {
    let ends = kinds.iter().filter_map(|kind| match kind {
        OpKind::Rapid { to } | OpKind::Line { to, .. } | OpKind::Arc { to, .. } => {
            Some(to.linear.map(units::Length::value))
        }
        _ => None,
    });
    ends.collect()
}

fn places(program: &str) -> Vec<[f64; 3]> {
    let (kinds, findings) = ops_with(program, &setup());
    assert_eq!(findings, [""; 0], "{program}");
    ends(&kinds)
}

#[track_caller]
fn goes_to(program: &str, wanted: &[[f64; 3]]) {
    let found = places(program);
    let near = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
    let same = found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| near(a, b));
    assert!(same, "found {found:?}, wanted {wanted:?}");
}

#[track_caller]
fn is_told(program: &str, code: &str) {
    let (_, findings) = ops_with(program, &setup());
    assert!(findings.iter().any(|f| f.starts_with(code)), "{code} is not among {findings:#?}");
}

/// Turned about a centre, counter-clockwise.
fn turned(degrees: f64, [cx, cy]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 3] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (x, y) = (x - cx, y - cy);
    [cx + x * cos - y * sin, cy + x * sin + y * cos, 0.0]
}

#[test]
fn a_rotation_turns_a_figure_about_its_centre() {
    // the manual's example: a square of 10, turned by 60° about (7, 3)
    let turn = |x, y| turned(60.0, [7.0, 3.0], [x, y]);
    goes_to(
        "G0 X-5. Y-5.\nG68 X7. Y3. R60.\nG1 X0 Y0\nG91 X10.\nY10.\nG90 X0\nY0\nG69 X-5. Y-5.",
        &[
            [-5.0, -5.0, 0.0],
            turn(0.0, 0.0),
            turn(10.0, 0.0),
            turn(10.0, 10.0),
            turn(0.0, 10.0),
            turn(0.0, 0.0),
            [-5.0, -5.0, 0.0],
        ],
    );
}

#[test]
fn what_is_added_after_a_rotation_is_turned_about_the_tool() {
    goes_to(
        "G0 X10. Y0\nG68 X0 Y0 R90.\nG91 G1 X5.\nY5.\nG69\nX1.",
        &[[10.0, 0.0, 0.0], [10.0, 5.0, 0.0], [5.0, 5.0, 0.0], [6.0, 5.0, 0.0]],
    );
}

#[test]
fn a_rotation_needs_no_centre_and_no_point_after_r() {
    goes_to("G0 X10. Y2.\nG68 R90000\nG1 X13. Y2.", &[[10.0, 2.0, 0.0], [10.0, 5.0, 0.0]]);
}

#[test]
fn arcs_are_turned_with_their_centres() {
    let program = "G0 X0 Y0\nG68 X0 Y0 R90.\nG2 X10. Y0 I5. J0\nX20. R5.\nG69";
    let (kinds, findings) = ops_with(program, &setup());
    assert_eq!(findings, [""; 0]);
    let arcs: Vec<_> = kinds
        .iter()
        .filter_map(|kind| match kind {
            OpKind::Arc { to, arc, .. } => Some((
                to.linear.map(|v| v.value().round()),
                arc.centre.map(|v| v.value().round()),
                arc.sweep.in_deg().round(),
            )),
            _ => None,
        })
        .collect();
    assert_eq!(
        arcs,
        [([0.0, 10.0, 0.0], [0.0, 5.0], -180.0), ([0.0, 20.0, 0.0], [0.0, 15.0], -180.0)]
    );
}

#[test]
fn holes_on_a_circle_are_named_by_radius_and_angle() {
    // the manual's bolt hole circle
    let hole = |degrees: f64, z| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        [100.0 * cos, 100.0 * sin, z]
    };
    let at = |degrees| [hole(degrees, 5.0), hole(degrees, -20.0), hole(degrees, 5.0)];
    let wanted: Vec<_> =
        std::iter::once([0.0, 0.0, 5.0]).chain([30.0, 150.0, 270.0].map(at).concat()).collect();
    let absolute =
        "S900 M3\nG0 Z5.\nG17 G90 G16\nG99 G81 X100. Y30. Z-20. R5.\nY150.\nY270.\nG15 G80";
    goes_to(absolute, &wanted);
    let added = "S900 M3\nG0 Z5.\nG17 G90 G16\nG99 G81 X100. Y30. Z-20. R5.\nG91 Y120. Z-25. R0\nY120.\nG15 G80";
    goes_to(added, &wanted);
}

#[test]
fn the_pole_is_the_place_at_hand_with_g91() {
    goes_to(
        "G0 X10. Y10.\nG91 G16\nG90 G1 X5. Y90.\nG15 X0 Y0",
        &[[10.0, 10.0, 0.0], [10.0, 15.0, 0.0], [0.0, 0.0, 0.0]],
    );
}

#[test]
fn scaling_keeps_its_centre_and_leaves_g50_the_true_size() {
    goes_to(
        "G51 X10. Y10. Z0 P2000\nG1 X20. Y10. Z-1.\nY20.\nG50\nX20. Y10.",
        &[[30.0, 10.0, -2.0], [30.0, 30.0, -2.0], [20.0, 10.0, -2.0]],
    );
}

#[test]
fn a_negative_factor_and_g51_1_mirror_and_turn_arcs_round() {
    for mirror in ["G51 X0 Y0 Z0 I-1000 J1000 K1000", "G51.1 X0"] {
        let program = format!("{mirror}\nG1 X10. Y0\nG2 X10. Y0 I-5. J0\nG3 X0 R5.\nX10. R5.");
        let (kinds, findings) = ops_with(&program, &setup());
        assert_eq!(findings, [""; 0], "{mirror}");
        let arcs: Vec<_> = kinds
            .iter()
            .filter_map(|kind| match kind {
                OpKind::Arc { to, arc, .. } => {
                    Some((to.linear[0].value(), arc.centre[0].value(), arc.sweep.in_deg()))
                }
                _ => None,
            })
            .collect();
        let wanted = [(-10.0, -5.0, 360.0), (0.0, -5.0, -180.0), (-10.0, -5.0, -180.0)];
        let near = arcs.iter().zip(wanted).all(|(a, b)| {
            (a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9 && (a.2 - b.2).abs() < 1e-6
        });
        assert!(arcs.len() == 3 && near, "{mirror}: {arcs:?}");
    }
}

#[test]
fn the_cutter_changes_sides_in_a_mirror() {
    // left of a way to +X is above it, and so it is in the mirror, where it is the right
    let setup = interp::example_setup(Dialect::Fanuc); // tool 1 has a diameter of 10 mm
    let program = "G51.1 X0\nG41 D1 G1 X30. Y0\nX60.\nG40 X90. Y20.";
    let (kinds, findings) = ops_with(program, &setup);
    assert_eq!(findings, [""; 0]);
    let on_the_way = ends(&kinds)[1];
    assert!((on_the_way[0] + 60.0).abs() < 1e-9, "{on_the_way:?}");
    assert!((on_the_way[1] - 5.0).abs() < 1e-9, "{on_the_way:?}");
}

#[test]
fn a_rotation_in_a_scaled_figure_has_a_scaled_centre() {
    // scaled first, then turned: (10, 0) about (5, 0), doubled about the origin
    goes_to("G51 X0 Y0 Z0 P2000\nG68 X5. Y0 R90.\nG1 X10. Y0\nG69\nG50", &[[10.0, 10.0, 0.0]]);
}

#[test]
fn what_cannot_be_done_in_these_coordinates_is_said() {
    is_told("G10 L12 P1 R1.\nG41 D1 X1. Y1.\nG68 X0 Y0 R5.", "I1040");
    is_told("G68 X0 Y0 R5.\nG51 X0 Y0 P2000", "I1041");
    is_told("G51 X0 Y0", "I1042");
    is_told("G51 X0 Y0 P0", "I1042");
    is_told("G51.1", "I1043");
    is_told("G68 X0 Y0", "I1044");
    is_told("G68 X0 Y0 R400.", "I1044");
    is_told("G68 X0 Y0 R5.\nG28 Z0", "I1045");
    is_told("G68 X0 Y0 R5.\nG55", "I1045");
    is_told("G16\nG18 G1 X1. Z1.", "I1045");
    is_told("S9 M3\nG51.1 Z0\nG81 X0 Z-5. R1.", "I1046");
    is_told("G51 X0 Y0 I2000 J1000\nG2 X10. Y0 I5.", "I1047");
    is_told("G68 X0 Y0 R30.\nG1 X10.", "I1048");
}

#[test]
fn offsets_and_dwells_are_no_figures() {
    let (_, findings) = ops_with("G68 X0 Y0 R30.\nG4 X1.\nG10 L2 P1 X5. Y5.\nG69", &setup());
    assert_eq!(findings, [""; 0]);
}

/// Ends of moves, and what the spindle does between them.
fn story(program: &str, setup: &Setup) -> Vec<String> {
    let (kinds, findings) = ops_with(program, setup);
    assert_eq!(findings, [""; 0]);
    let told = kinds.iter().filter_map(|kind| match kind {
        OpKind::Rapid { to } => Some(format!("rapid {:?}", to.linear.map(units::Length::value))),
        OpKind::Line { to, .. } => Some(format!("feed {:?}", to.linear.map(units::Length::value))),
        OpKind::Dwell { time } => Some(format!("wait {}", time.value())),
        OpKind::Spindle { order: SpindleOrder::Orient { to, .. }, .. } => {
            Some(format!("stand at {}", to.angle.in_deg()))
        }
        OpKind::Spindle { order: SpindleOrder::Turn(spin), .. } => {
            Some(format!("turn {}", spin.in_rpm().round()))
        }
        _ => None,
    });
    told.collect()
}

#[test]
fn fine_boring_leaves_the_bore_beside_its_wall() {
    let program = "S500 M3\nG0 Z20.\nG98 G76 X10. Y5. Z-30. R2. Q0.5 P1000\nG80";
    assert_eq!(
        story(program, &setup()),
        [
            "turn 500",
            "rapid [0.0, 0.0, 20.0]",
            "rapid [10.0, 5.0, 20.0]",
            "rapid [10.0, 5.0, 2.0]",
            "feed [10.0, 5.0, -30.0]",
            "wait 1",
            "stand at 0",
            "rapid [10.5, 5.0, -30.0]",
            "rapid [10.5, 5.0, 20.0]",
            "rapid [10.0, 5.0, 20.0]",
            "turn 500",
        ]
    );
}

#[test]
fn back_boring_goes_down_beside_the_bore_and_cuts_upwards() {
    // the manual's example: R is the lower end, Z the upper; the machine moves aside along -Y
    let aside = Aside { second: true, back: true };
    let setup = Setup { cycles: Cycles { aside, ..Cycles::default() }, ..setup() };
    let program = "S500 M3\nG0 Z20.\nG98 G87 X10. Y5. Z-20. R-35. Q3. P1000\nG80";
    assert_eq!(
        story(program, &setup),
        [
            "turn 500",
            "rapid [0.0, 0.0, 20.0]",
            "rapid [10.0, 5.0, 20.0]",
            "stand at 0",
            "rapid [10.0, 2.0, 20.0]",
            "rapid [10.0, 2.0, -35.0]",
            "rapid [10.0, 5.0, -35.0]",
            "turn 500",
            "feed [10.0, 5.0, -20.0]",
            "wait 1",
            "stand at 0",
            "rapid [10.0, 2.0, -20.0]",
            "rapid [10.0, 2.0, 20.0]",
            "rapid [10.0, 5.0, 20.0]",
            "turn 500",
        ]
    );
}

#[test]
fn boring_cycles_say_what_they_miss() {
    is_told("S500 M3\nG76 X1. Y1. Z-5. R1.", "I0590");
    is_told("S500 M3\nG99 G87 X1. Y1. Z-5. R-9. Q1.", "I0591");
    is_told("S500 M3\nG98 G87 X1. Y1. Z-9. R-5. Q1.", "I0519");
    is_told("G98 G87 X1. Y1. Z-5. R-9. Q1.", "I0515");
    let (_, findings) = ops_with("S500 M3\nG0 Z5.\nG88 X1. Y1. Z-5. R1.\nG80", &setup());
    assert_eq!(findings, [""; 0]);
}

#[test]
fn no_other_dialect_can_write_fanucs_own_cycles() {
    let setup = Setup { missing_tools: MissingTools::StandIn, ..Setup::default() };
    let found = interp::check(b"S500 M3 F100\nG1076 X1 Y1 Z-5 R1 Q1\nM2\n", &setup);
    assert_eq!(found.first().map(|finding| finding.code), Some("I0102"));
}

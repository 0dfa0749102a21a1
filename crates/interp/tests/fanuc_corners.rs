//! Fanuc's `,C` and `,R`: where a corner begins and ends, by the geometry of the drawing.
use canon::OpKind;
use interp::{Dialect, MissingTools, Ops, Setup};

fn setup(dialect: Dialect) -> Setup {
    Setup { dialect, missing_tools: MissingTools::StandIn, ..Setup::default() }
}

/// Lines and arcs (end, centre, sweep in degrees) of a program.
fn moves(program: &str, setup: &Setup) -> (Vec<String>, Vec<String>) {
    let mut ops = Ops::new(program.as_bytes(), setup);
    let round = |value: f64| (value * 1e4).round() / 1e4 + 0.0;
    let told = |op: canon::Op| match op.kind {
        OpKind::Line { to, .. } => {
            let [x, y, z] = to.linear.map(|v| round(v.value()));
            Some(format!("line {x} {y} {z}"))
        }
        OpKind::Arc { to, arc, .. } => {
            let [x, y, z] = to.linear.map(|v| round(v.value()));
            let [a, b] = arc.centre.map(|v| round(v.value()));
            Some(format!("arc {x} {y} {z} about {a} {b} by {}", round(arc.sweep.in_deg())))
        }
        _ => None,
    };
    let found = ops.by_ref().filter_map(told).collect();
    let findings = ops.diagnostics().into_iter().filter(|d| d.code != "I1023");
    (found, findings.map(|d| format!("{} {}", d.code, d.message)).collect())
}

#[track_caller]
fn does(dialect: Dialect, program: &str, wanted: &[&str]) {
    let (found, findings) = moves(program, &setup(dialect));
    assert_eq!(findings, [""; 0], "{program}");
    assert_eq!(found, wanted, "{program}");
}

#[track_caller]
fn is_told(program: &str, wanted: &str) {
    let (_, findings) = moves(program, &setup(Dialect::Fanuc));
    assert!(findings.iter().any(|f| f.contains(wanted)), "{findings:#?}");
}

#[test]
fn a_right_angle_is_rounded_and_cut_off() {
    // R 2 touches both ways 2 from the corner; C 3 ends 3 from it on both
    does(
        Dialect::Fanuc,
        "O1\nG1F100X10.,R2.\nY10.,C3.\nX0\nM30\n",
        &["line 8 0 0", "arc 10 2 0 about 8 2 by 90", "line 10 7 0", "line 7 10 0", "line 0 10 0"],
    );
}

#[test]
fn increments_count_from_the_corner() {
    does(
        Dialect::Fanuc,
        "O1\nG91G1F100X10.,R2.\n(ON)\nY-10.,C3.\nX5.\nG90M30\n",
        &[
            "line 8 0 0",
            "arc 10 -2 0 about 8 -2 by -90",
            "line 10 -7 0",
            "line 13 -10 0",
            "line 15 -10 0",
        ],
    );
}

#[test]
fn a_sharp_corner_takes_more_of_its_ways() {
    // an equilateral triangle of 20: R 3 takes 3/tan 30° of both ways, and turns by 120°
    let takes = 3.0 / 30f64.to_radians().tan();
    let begin = 20.0 - takes;
    let end = [20.0 - takes / 2.0, takes * 60f64.to_radians().sin()];
    let near = |text: &str, wanted: &[f64]| {
        let found: Vec<f64> =
            text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-3)
    };
    let (found, findings) =
        moves("O1\nG1F100X20.,R3.\nX10.Y17.320508\nM30\n", &setup(Dialect::Fanuc));
    assert_eq!(findings, [""; 0]);
    assert!(near(&found[0], &[begin, 0.0, 0.0]), "{found:?}");
    assert!(near(&found[1], &[end[0], end[1], 0.0, begin, 3.0, 120.0]), "{found:?}");
}

#[test]
fn corners_follow_each_other_and_repeat_by_variables() {
    does(
        Dialect::Fanuc,
        "O1\n#1=1.5\nG1F100X4.,R#1\nY4.,R#1\nX0,R#0\nY0\nM30\n",
        &[
            "line 2.5 0 0",
            "arc 4 1.5 0 about 2.5 1.5 by 90",
            "line 4 2.5 0",
            "arc 2.5 4 0 about 2.5 2.5 by 90",
            "line 0 4 0",
            "line 0 0 0",
        ],
    );
}

#[test]
fn a_corner_that_does_not_fit_says_what_does() {
    is_told(
        "O1\nG1F100X4.,R3.\nY2.\nM30\n",
        "R3 does not fit into this corner: its ways leave room for R2.000",
    );
    is_told("O1\nG1F100X4.,R2.5\nY4.,R2.\nX0\nM30\n", "leave room for R1.500");
    is_told("O1\nG1F100X4.,C1.\nX2.\nM30\n", "there is no corner here");
    is_told("O1\nG1F100X4.,C1.\nG0Y4.\nM30\n", "the next block is no G1");
    is_told("O1\nG0X4.,C1.\nG1F100Y4.\nM30\n", "a corner follows a straight feed");
    is_told("O1\nG1F100X4.,C1.,R1.\nY4.\nM30\n", "not both");
    is_told("O1\nG1F100X4.,C-1.\nY4.\nM30\n", "above 0");
    // ways in one line have no corner to be rounded
    does(Dialect::Fanuc, "O1\nG1F100X4.,R1.\nX8.\nM30\n", &["line 4 0 0", "line 8 0 0"]);
}

#[test]
fn a_lathes_corners_need_no_comma() {
    // X is a diameter: from (20, 0) down to Z-10, chamfer 1 to X30, radius 2 on the way to Z-20
    let wanted = [
        "line 10 0 -9",
        "line 11 0 -10",
        "line 13 0 -10",
        "arc 15 0 -12 about -12 13 by 90",
        "line 15 0 -20",
    ];
    let program = |c: &str| format!("O1\nG98G0X20.Z0\nG1F100Z-10.{c}1.\nX30.R2.\nZ-20.\nM30\n");
    let lathe = Setup { c_is_a_chamfer: true, ..setup(Dialect::FanucLatheA) };
    for c in ["C", ",C", "I", "C-"] {
        let (found, findings) = moves(&program(c), &lathe);
        assert_eq!(findings, [""; 0], "{c}");
        let arc = |text: &&String| text.starts_with("arc");
        assert_eq!(found.iter().filter(arc).count(), 1, "{found:?}");
        let flat = |text: &String| text.split(" by ").next().unwrap().to_owned();
        let wanted: Vec<_> = wanted.iter().map(|w| flat(&(*w).to_owned())).collect();
        assert_eq!(found.iter().map(flat).collect::<Vec<_>>(), wanted, "{c}");
    }
    // with a C axis C is one
    let (found, _) = moves(&program("C"), &setup(Dialect::FanucLatheA));
    assert_eq!(found[0], "line 10 0 -10");
}

#[test]
fn corners_are_in_a_profile_too() {
    let program = |corner: &str| {
        format!("O1\nG98F100G0X30.Z2.\nG70P10Q20\nM30\nN10G0X20.\nG1Z-10.{corner}\nN20X30.\n")
    };
    // also where the feed before it is the profile's own, and without a comma
    let program_of_two =
        "O1\nG98F100G0X30.Z2.\nG70P10Q20\nM30\nN10G0X20.\nG1Z-10.\nX30.R2.\nN20Z-20.\n";
    let (found, findings) = moves(program_of_two, &setup(Dialect::FanucLatheA));
    assert_eq!(findings, [""; 0]);
    assert_eq!(found[..2], ["line 10 0 -10", "line 13 0 -10"]);
    assert!(found[2].starts_with("arc 15 0 -12 about -12 13"), "{found:?}");
    // read twice: what a corner of the first reading took is not missing in the second
    let twice = "O1\nG98F100G0X30.Z2.\nG70P10Q20\nG70P10Q20\nM30\nN10G0X18.Z0\nG1X20.,C1.\nZ-9.,R2.\nX26.\nN20Z-10.\n";
    let (found, findings) = moves(twice, &setup(Dialect::FanucLatheA));
    assert_eq!(findings, [""; 0]);
    assert_eq!(found.len() % 2, 0);
    assert_eq!(found[..found.len() / 2], found[found.len() / 2..]);
    assert!(found.contains(&"line 10 0 -1".to_owned()), "{found:?}");
    let (found, findings) = moves(&program(",C1."), &setup(Dialect::FanucLatheA));
    assert_eq!(findings, [""; 0]);
    assert_eq!(found, ["line 10 0 -9", "line 11 0 -10", "line 15 0 -10"]);
}

#[test]
fn the_cutter_goes_beside_a_corner() {
    // D1 is 5 mm of radius: on the left of the way, inside a left turn of R 8, the arc has 3 mm
    let setup = interp::example_setup(Dialect::Fanuc);
    let program = "O1\nF100\nG41D1G1X10.Y0\nX40.,R8.\nY40.\nG40X20.Y50.\nM30\n";
    let (found, findings) = moves(program, &setup);
    assert_eq!(findings, [""; 0]);
    assert_eq!(found[1..4], ["line 32 5 0", "arc 35 8 0 about 32 8 by 90", "line 35 40 0"]);
}

//! Cutter radius compensation, kept modes, probing and splines: what is ordered, against closed
//! forms and what LinuxCNC's stand-alone interpreter printed.
use interp::{Call, Interpreter, Place, Setup, Sink};

/// Ends of the moves in X and Y.
#[derive(Default)]
struct Ends(Vec<[f64; 2]>);

impl Sink for Ends {
    fn call(&mut self, _: &Place, call: &Call<'_>) {
        if let Call::Line(to) | Call::Rapid(to) | Call::Arc { to, .. } = call {
            self.0.push([to[0], to[1]]);
        }
    }
}

fn ends(program: &str) -> (Vec<[f64; 2]>, Vec<&'static str>) {
    let setup = Setup::default();
    let mut interpreter = Interpreter::new(program.as_bytes(), &setup);
    let mut ends = Ends::default();
    interpreter.run(&mut ends);
    let errors = interpreter.diagnostics().iter().filter(|d| d.is_error());
    (ends.0, errors.map(|d| d.code).collect())
}

fn assert_ends(program: &str, wanted: &[[f64; 2]]) {
    let (found, errors) = ends(program);
    assert_eq!(errors, [""; 0]);
    assert_eq!(found.len(), wanted.len(), "{found:?}");
    for (found, wanted) in found.iter().flatten().zip(wanted.iter().flatten()) {
        assert!((found - wanted).abs() < 1e-9, "{found} instead of {wanted}");
    }
}

#[test]
fn on_the_left_the_tool_goes_round_a_right_turn_and_cuts_a_left_turn_short() {
    assert_ends(
        "G41.1 D2\nG1 X10 F100\nY10\nX20\nY20\nG40\nX30\nM2\n",
        &[[9., 1.], [9., 10.], [10., 11.], [19., 11.], [19., 20.], [30., 20.]],
    );
}

#[test]
fn a_line_ends_where_its_offset_meets_the_offset_circle() {
    // y = 1 and a circle of radius 6 about (15, 0): x = 15 ∓ √35.
    let x = 35f64.sqrt();
    assert_ends(
        "G41.1 D2\nG1 X10 F100\nG2 X20 Y0 I5 J0\nG1 X30\nG40\nM2\n",
        &[[15. - x, 1.], [15. + x, 1.], [30., 1.]],
    );
}

#[test]
fn a_move_along_the_normal_keeps_the_corner_where_it_is() {
    assert_ends("G41.1 D2\nG1 X10 F100\nZ-1\nY10\nG40\nM2\n", &[[9., 1.], [9., 1.], [9., 10.]]);
}

#[test]
fn the_tool_stays_a_radius_away_from_every_line_of_a_closed_shape() {
    let corners = [[0., 0.], [30., 5.], [25., 40.], [10., 20.], [-5., 38.]];
    let mut program = String::from("G0 X-20 Y-20\nG42.1 D3\n");
    for [x, y] in corners.iter().chain(&corners[..2]) {
        program += &format!("G1 X{x} Y{y} F100\n");
    }
    let (found, errors) = ends(&(program + "G40\nM2\n"));
    assert_eq!(errors, [""; 0]);
    for end in &found[2..found.len() - 1] {
        let distance = |i: usize| {
            let (a, b): ([f64; 2], [f64; 2]) = (corners[i], corners[(i + 1) % corners.len()]);
            let (along, to) = ([b[0] - a[0], b[1] - a[1]], [end[0] - a[0], end[1] - a[1]]);
            let length = along[0].hypot(along[1]);
            let t = ((to[0] * along[0] + to[1] * along[1]) / (length * length)).clamp(0., 1.);
            (to[0] - t * along[0]).hypot(to[1] - t * along[1])
        };
        let nearest = (0..corners.len()).map(distance).fold(f64::INFINITY, f64::min);
        assert!((nearest - 1.5).abs() < 1e-9, "{end:?} is {nearest} away");
    }
}

#[test]
fn what_would_cut_into_the_part_is_refused() {
    assert_eq!(ends("G41.1 D2\nG1 X10 F100\nY0.5\nX20\nM2\n").1, ["I0548"]);
    assert_eq!(ends("G41.1 D2\nG1 X0.9 F100\nM2\n").1, ["I0545"]);
    assert_eq!(ends("G42.1 D2\nG1 X10 F100\nG2 X11 Y0 I.5 J0\nM2\n").1, ["I0546"]);
    assert_eq!(ends("G41.1 D2\nG1 X10 F100\nG40\nG2 X20 I5 J0\nM2\n").1, ["I0550"]);
    assert_eq!(ends("G41.1 D2\nG1 X10 F100\nG43.1 Z1\nM2\n").1, ["I0544"]);
}

#[test]
fn what_a_block_orders_before_and_after_its_g40_to_g42_meets_what_is_then_in_force() {
    let error = |program: &str| ends(&format!("{program}\nM2\n")).1;
    for after in ["G43.1 Z1", "G49", "G55", "G54", "G61", "G28.1", "G92 X1", "G52 X1", "G53 G0 X9"]
    {
        assert_eq!(error(&format!("G41.1 D2 {after}")), ["I0544"], "{after}");
        assert_eq!(error(&format!("G41.1 D2\n{after}")), ["I0544"], "{after}");
        assert_eq!(error(&format!("G41.1 D2\nG40 {after}")), [""; 0], "{after}");
    }
    for before in ["G18", "M61 Q0", "M48", "M53 P0", "M66 P0", "M62 P1", "M67 E0 Q1"] {
        assert_eq!(error(&format!("G41.1 D2 {before}")), [""; 0], "{before}");
        assert_eq!(error(&format!("G41.1 D2\n{before}")), ["I0544"], "{before}");
        assert_eq!(error(&format!("G41.1 D2\nG40 {before}")), ["I0544"], "{before}");
    }
}

#[test]
fn an_arc_leads_the_tool_in_only_where_it_can_end_along_it() {
    // From (0, 0) to beside (5, 5) of a circle about (0, 5): to (3, 5), with its centre on the line
    // y = 5, where (x − 3)² = x² + 25: −8/3.
    let (found, errors) = ends("G41.1 D4\nG3 X5 Y5 J5 F100\nG1 Y9\nX-9\nG40\nM2\n");
    assert_eq!(errors, [""; 0]);
    assert_eq!(found, [[3., 5.], [3., 7.], [-9., 7.]]);
    // Outside, the arc may be smaller than the tool.
    assert_eq!(ends("G41.1 D8\nG2 X6 Y0 I3 F100\nG1 Y-9\nG40\nM2\n").1, [""; 0]);
    // The tool would have to bend the other way; its arc would be smaller than itself.
    assert_eq!(ends("G41.1 D4\nG3 X3 Y1 J5 F100\nG1 X9 Y9\nM2\n").1, ["I0547"]);
    assert_eq!(ends("G42.1 D4\nG3 X1.4 Y0.2 J5 F100\nG1 X9 Y9\nM2\n").1, ["I0547"]);
}

#[test]
fn back_almost_the_way_it_came_the_tool_goes_round_the_corner() {
    // Directions of 178° and 182°: within 0.05 rad of straight back. An arc ends on either side of
    // its normal.
    let (sin, cos) = 2f64.to_radians().sin_cos();
    for sign in [1., -1.] {
        let back = [-20. * cos, sign * 20. * sin];
        let program =
            format!("G0 X-20\nG41.1 D2\nG1 X0 F100\nX{} Y{}\nG40\nG0 Y9\nM2\n", back[0], back[1]);
        let round = [-sign * sin, -cos];
        let beside = [back[0] + round[0], back[1] + round[1]];
        assert_ends(&program, &[[-20., 0.], [0., 1.], round, beside, [back[0], 9.]]);
    }
    // Beside an arc that bulges towards the tool it stops where the two offset ways meet: y = 1 and
    // a circle of radius 6 about 5 (−sin 2°, cos 2°).
    let centre = [-5. * sin, 5. * cos];
    let program = format!(
        "G0 X-20\nG41.1 D2\nG1 X0 F100\nG2 X{} Y{} I{} J{}\nG40\nG0 Y20\nM2\n",
        centre[0] - 5.,
        centre[1],
        centre[0],
        centre[1]
    );
    let x = centre[0] - (36. - (centre[1] - 1.).powi(2)).sqrt();
    let end = [centre[0] - 6., centre[1]];
    assert_ends(&program, &[[-20., 0.], [x, 1.], end, [centre[0] - 5., 20.]]);
}

#[test]
fn a_subprogram_that_keeps_its_modes_leaves_none_behind() {
    assert_ends(
        "o1 sub\nM73\nG91 G1 X1 F100\nX1\no1 endsub\nG90\no1 call\nG1 X5 F50\nM2\n",
        &[[1., 0.], [2., 0.], [5., 0.]],
    );
    assert_eq!(ends("M72\nM2\n").1, ["I0321"]);
}

#[test]
fn a_probe_touches_at_the_programmed_end_and_stands_a_little_back() {
    let (found, errors) = ends("G38.2 X10 F100\nG1 X#5061\nG1 Y#<_x>\nM2\n");
    assert_eq!(errors, [""; 0]);
    assert_eq!(found, [[10., 0.], [10., 10.]]); // the probing itself is no plain move
    assert_eq!(ends("G38.2 X0 F100\nM2\n").1, ["I0572"]);
}

#[test]
fn a_spline_is_one_operation_and_its_curve_is_the_programmed_one() {
    // A quadratic Bézier curve over (0, 0), (10, 20), (20, 0) is the parabola y = 2x(1 − x/20).
    let setup = Setup::default();
    let program = b"G5.1 I10 J20 X20 Y0 F100\nM2\n";
    let splines = interp::Ops::new(program, &setup).filter_map(|op| match op.kind {
        canon::OpKind::Spline { to, spline, .. } => Some((to, spline)),
        _ => None,
    });
    let splines: Vec<_> = splines.collect();
    let [(to, spline)] = splines.as_slice() else { panic!("{splines:?}") };
    assert_eq!(to.linear.map(units::Length::value), [20.0, 0.0, 0.0]);
    let [ahead] = spline.pieces.as_slice() else { panic!("{spline:?}") };
    // raised to the fifth degree: x goes evenly, and the parabola's blossom says y
    for (k, [x, y]) in (1..).map(f64::from).zip(ahead) {
        let (even, raised) = (4.0 * k, 40.0 * (k / 5.0 - k * (k - 1.0) / 20.0));
        assert!((x.value() - even).abs() < 1e-9, "{ahead:?}");
        assert!((y.value() - raised).abs() < 1e-9, "{ahead:?}");
    }
    assert_eq!(ends("G5.2 P1 X1 Y1 F10\nP1 X2 Y0\nG1 X3\nM2\n").1, ["I0558"]);
}

#[test]
fn with_g91_all_control_points_of_a_nurbs_count_from_its_beginning() {
    let at_end = |program: &str| ends(&format!("G0 X10\n{program}\nG90 G1 Z1\nM2\n"));
    let (absolute, errors) = at_end("G5.2 P1 L2 F100\nX12 Y3 P1\nX14 Y1 P1\nG5.3");
    assert_eq!(errors, [""; 0]);
    assert_eq!(absolute, [[10., 0.], [14., 1.]]);
    assert_eq!(at_end("G91 G5.2 P1 L2 F100\nX2 Y3 P1\nX4 Y1 P1\nG5.3").0, absolute);
}

fn in_fanucs(program: &str) -> (Vec<[f64; 2]>, Vec<&'static str>) {
    let tools = interp::example_setup(interp::Dialect::Fanuc);
    let mut interpreter = Interpreter::new(program.as_bytes(), &tools);
    let mut ends = Ends::default();
    interpreter.run(&mut ends);
    (ends.0, interpreter.diagnostics().iter().filter(|d| d.is_error()).map(|d| d.code).collect())
}

/// Fanuc's type A: at the end of the start-up block the tool stands beside the beginning of the
/// next one, at right angles to it, whatever the angle between the two.
#[test]
fn in_fanucs_dialect_the_tool_starts_up_to_beside_the_next_moves_beginning() {
    // an arc of radius 7 about the origin from (7, 0), run through to the left; the tool of radius
    // 2 is inside of it
    for degrees in [-82.0, -30.0, 0.0, 40.0, 82.0, 120.0, 170.0_f64] {
        let (sin, cos) = (degrees + 90.0).to_radians().sin_cos();
        let from = [7.0 - 3.0 * cos, -3.0 * sin];
        let text = format!(
            "O1\nG90 G17\nG10 L12 P1 R2.\nG0 X{:.6} Y{:.6}\nG41 D1 G1 X7. Y0. F100.\nG3 X-7. I-7. J0.\nG40 G1 X0.\nM30\n",
            from[0], from[1]
        );
        let (found, errors) = in_fanucs(&text);
        assert_eq!(errors, [""; 0], "{degrees}°");
        let [x, y] = found[1];
        assert!((x - 5.0).abs() < 1e-9 && y.abs() < 1e-9, "{degrees}°: {:?}", found[1]);
        let [x, y] = found[2];
        assert!((x + 5.0).abs() < 1e-9 && y.abs() < 1e-9, "{degrees}°: {:?}", found[2]);
    }
}

#[test]
fn a_start_up_that_is_shorter_than_the_radius_or_along_the_tool_is_fanucs_as_well() {
    let (found, errors) = in_fanucs(
        "O1\nG90 G17\nG10 L12 P1 R2.\nG0 X0. Y0.\nG41 D1\nG1 Z-1. F100.\nG1 X1. Y0.\nY10.\nG40 X20.\nM30\n",
    );
    assert_eq!(errors, [""; 0]);
    assert_eq!(found, [[0., 0.], [0., 0.], [-1., 0.], [-1., 10.], [20., 10.]]);
}

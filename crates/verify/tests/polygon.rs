//! Polygons cut by tips whose paths are known in closed form, and judged from samples alone.
use bus::{Sample, State, Truth};
use canon::{
    Axis, Feed, Harmonic, Op, OpKind, Oscillating, Oscillation, PolygonCutter, Position, Ratio,
    Span, Tool, ToolKind, ToolLibrary,
};
use core::f64::consts::{PI, TAU};
use units::{Angle, Coordinate, Lead, Length, Spin, Time};
use verify::{Config, Feature, FeatureKind, Judge, Polygon, Stock};

/// A cut as the equations have it: mm, rad, turns.
struct Cut {
    inserts: Vec<f64>,
    radius: f64,
    centres: f64,
    ratio: Ratio,
    phase: f64,
    /// dx, dy (mm) and the tool's advance (rev) by the work's angle (rad).
    swing: fn(f64) -> [f64; 3],
    /// mm per turn of the work.
    feed: f64,
    nose: f64,
    stock: f64,
    /// X per Z, both in mm.
    taper: f64,
    /// Where the program has its zero, off the work's.
    zero_off: [f64; 3],
}

const RPM: f64 = 500.0;
/// Machine Z at which the cutter, 40 mm long, is at the face of the bar.
const TOP: f64 = -350.0 + 40.0;

/// A bar of this radius about the work's axis, its face at the work's zero.
fn stock(radius: f64) -> Stock {
    let mm = |v: [f64; 3]| v.map(Length::mm);
    Stock {
        from: mm([-150.0 - radius, -60.0 - radius, -410.0]),
        to: mm([-150.0 + radius, -60.0 + radius, -350.0]),
        zero: mm([-150.0, -60.0, -350.0]),
    }
}

impl Cut {
    fn hexagon() -> Self {
        Self {
            inserts: vec![0.0, 1.0 / 3.0, 2.0 / 3.0],
            radius: 50.0,
            centres: 58.5,
            ratio: Ratio { follower: 2, master: 1 },
            phase: 0.0,
            swing: |_| [0.0; 3],
            feed: 0.1,
            nose: 0.0,
            stock: 12.0,
            taper: 0.0,
            zero_off: [0.0; 3],
        }
    }

    /// The document's square: N = 2, l = 10, r = 5.
    fn document(swing: fn(f64) -> [f64; 3]) -> Self {
        Self {
            inserts: vec![0.0, 0.5],
            radius: 5.0,
            centres: 10.0,
            swing,
            stock: 12.0,
            ..Self::hexagon()
        }
    }

    fn judged(&self) -> Feature {
        over(&[(self, STEPS)]).remove(0)
    }

    fn tool(&self) -> Tool {
        Tool {
            number: 9,
            pocket: 9,
            length: Length::mm(40.0),
            diameter: Length::mm(2.0 * self.radius),
            kind: ToolKind::PolygonCutter(PolygonCutter {
                radius: Length::mm(self.radius),
                inserts: self.inserts.iter().map(|d| Angle::rev(*d)).collect(),
                nose_radius: Length::mm(self.nose),
            }),
            description: String::new(),
            wear: canon::ToolWear::default(),
            life: canon::ToolLife::default(),
            body: canon::Body::default(),
            stand_in: false,
        }
    }

    /// Orders it from the operation `first` on, and cuts it in `steps` periods.
    fn cut(&self, judge: &mut Judge, first: u32, steps: u32) {
        let op = |line, kind| Op { span: Span { line, ..Span::default() }, kind };
        let polygon = canon::Polygon {
            work: 0,
            tool: 1,
            ratio: self.ratio,
            phase: Angle::rev(self.phase),
            oscillations: vec![Oscillation {
                on: Oscillating::Axis(Axis::X),
                harmonics: vec![Harmonic { per_turn: 6, cosine: 0.0, sine: 0.0 }],
            }],
            auto: None,
            by_distance: Vec::new(),
            wanted: Vec::new(),
            compensated: false,
            zero: {
                let [x, y, z] = self.zero_off;
                Position::xyz(-150.0 + x, -60.0 + y, TOP + z)
            },
            own_zero: None,
        };
        judge.op(first, &op(first + 1, OpKind::ChangeTool { number: 9 }));
        judge.op(first + 1, &op(first + 2, OpKind::Polygon(polygon)));
        let place = |z: f64| {
            let x = -150.0 + self.centres + self.taper * (z - TOP);
            Position::xyz(x, -60.0, z)
        };
        let feed = Feed::PerRevolution(Lead::mm_per_rev(self.feed));
        judge.op(first + 2, &op(first + 3, OpKind::Rapid { to: place(TOP + 0.3) }));
        judge.op(first + 3, &op(first + 4, OpKind::Line { to: place(TOP - 5.0), feed }));
        judge.op(first + 4, &op(first + 5, OpKind::PolygonEnd));
        let spin = Spin::rpm(RPM);
        for step in 0..steps {
            let time = Time::s(f64::from(step) * 250e-6);
            let work = (spin * time).value();
            let [dx, dy, ahead] = (self.swing)(work * TAU);
            let mut sample = Sample::default();
            sample.feedback.time = time + Time::s(f64::from(first));
            sample.feedback.tool = Some(9);
            sample.report.op = first + 3;
            sample.report.state = State::Feed;
            let mut truth = Truth::default();
            let z = TOP + 0.3 - self.feed * work;
            truth.axes[0] = Coordinate::new(place(z).linear[0].value() + dx);
            truth.axes[1] = Coordinate::new(-60.0 + dy);
            truth.axes[2] = Coordinate::new(z);
            truth.spindles =
                [Angle::rev(work), Angle::rev(work * self.ratio.value() + self.phase + ahead)];
            sample.truth = Some(truth);
            judge.sample(&sample);
        }
    }

    fn polygon(&self) -> Polygon {
        let FeatureKind::Polygon(polygon) = self.judged().kind else { panic!("a polygon") };
        *polygon
    }

    /// Independent of facets, passes and grids: on each ray from the work's axis, every crossing of
    /// every insert's path is found by bisection and the innermost counts; then the minimum zone is
    /// searched for.
    fn flatness_um(&self, normal: f64, half: f64) -> f64 {
        const RAYS: i32 = 90;
        let tip = |insert: f64, phi: f64| {
            let [dx, dy, ahead] = (self.swing)(phi);
            let (l, r) = (self.centres + dx, self.radius);
            let psi = (self.ratio.value() - 1.0) * phi + TAU * (insert + self.phase + ahead);
            [
                l * phi.cos() + dy * phi.sin() - r * psi.cos(),
                -l * phi.sin() + dy * phi.cos() - r * psi.sin(),
            ]
        };
        let innermost = |ray: f64| {
            // distance across the ray; a crossing in front of the axis is one of this ray
            let across = |p: [f64; 2]| p[1] * ray.cos() - p[0] * ray.sin();
            let along = |p: [f64; 2]| p[0] * ray.cos() + p[1] * ray.sin();
            let steps = 4000 * self.ratio.master;
            let mut least = f64::INFINITY;
            for insert in &self.inserts {
                for i in 0..steps {
                    let at = |i: i32| {
                        TAU * f64::from(self.ratio.master) * (f64::from(i) + 0.1) / f64::from(steps)
                    };
                    let (mut a, mut b) = (at(i), at(i + 1));
                    let (fa, fb) = (across(tip(*insert, a)), across(tip(*insert, b)));
                    if fa * fb > 0.0 || along(tip(*insert, a)) < 0.0 {
                        continue;
                    }
                    for _ in 0..50 {
                        let c = f64::midpoint(a, b);
                        if across(tip(*insert, c)) * fa > 0.0 { a = c } else { b = c }
                    }
                    least = least.min(along(tip(*insert, a)));
                }
            }
            least
        };
        let facet: Vec<[f64; 2]> = (-RAYS..=RAYS)
            .map(|i| {
                let off = half * f64::from(i) / f64::from(RAYS);
                let r = innermost(normal + off);
                [r * off.sin(), r * off.cos()]
            })
            .collect();
        let width = |slope: f64| {
            let above = facet.iter().map(|[s, n]| n - slope * s);
            let (low, high) =
                above.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            high - low
        };
        (-200..=200).map(|i| width(f64::from(i) * 1e-5)).fold(f64::INFINITY, f64::min) * 1e3
    }
}

/// Periods of a cut, 2.2 mm long.
const STEPS: u32 = 12_000;

/// What is left of cuts over one another with the cutter of the first, each with its periods.
fn over(cuts: &[(&Cut, u32)]) -> Vec<Feature> {
    let first = cuts[0].0;
    let mut judge = Judge::new(Config {
        work_axis: [Length::mm(-150.0), Length::mm(-60.0)],
        stock_radius: Some(Length::mm(first.stock)),
        stock: Some(stock(first.stock)),
        ..Config::new(ToolLibrary::new([first.tool()]))
    });
    let mut next = 0;
    for (cut, steps) in cuts {
        cut.cut(&mut judge, next, *steps);
        next += 5;
    }
    let span = Span { line: next + 1, ..Span::default() };
    judge.op(next, &Op { span, kind: OpKind::End });
    judge.finish()
}

#[track_caller]
fn near(found: f64, expected: f64, by: f64) {
    assert!((found - expected).abs() <= by, "found {found}, expected {expected} ± {by}");
}

#[test]
fn a_hexagon_without_oscillation_bulges_by_what_the_ellipse_says() {
    // y² /(l+r)² + x²/(l−r)² = 1 at the corner, y = 17/2·tan 30°, about 8.7 µm
    let polygon = Cut::hexagon().polygon();
    let (a, b): (f64, f64) = (8.5, 108.5);
    let corner = {
        // where ellipse and its neighbour meet: on the ray at 30°
        let (c, s) = (30_f64.to_radians().cos(), 30_f64.to_radians().sin());
        1.0 / ((c / a).powi(2) + (s / b).powi(2)).sqrt() * c
    };
    let bulge = (a - corner) * 1e3;
    near(bulge, 8.7, 0.1);
    near(polygon.flatness.in_um(), bulge, 0.1);
    assert_eq!(polygon.sides, 6);
    near(polygon.across_flats.value(), 17.0 - bulge * 1e-3, 1e-4);
    near(polygon.across_flats_ordered.value(), 17.0, 1e-9);
    near(polygon.corner_angle.in_deg(), 120.0, 1e-3);
    near(polygon.tilt.in_deg(), 0.0, 1e-3);
    near(polygon.facet_difference.in_um(), 0.0, 0.01);
    near(polygon.spin.in_rpm(), 500.0, 0.01);
}

#[test]
fn the_documents_squares_are_measured_to_a_tenth_of_a_micrometre() {
    type Swing = fn(f64) -> [f64; 3];
    let cases: [(&str, Swing); 7] = [
        ("none", |_| [0.0; 3]),
        ("X 0.03", |t| [0.03 * 10.0 * (1.0 - (4.0 * t).cos()), 0.0, 0.0]),
        ("X 0.06", |t| [0.06 * 10.0 * (1.0 - (4.0 * t).cos()), 0.0, 0.0]),
        ("X 0.15", |t| [0.15 * 10.0 * (1.0 - (4.0 * t).cos()), 0.0, 0.0]),
        ("Y 0.06", |t| [0.0, 0.06 * 10.0 * (4.0 * t).sin(), 0.0]),
        ("Y 0.12", |t| [0.0, 0.12 * 10.0 * (4.0 * t).sin(), 0.0]),
        ("Y 0.18", |t| [0.0, 0.18 * 10.0 * (4.0 * t).sin(), 0.0]),
    ];
    for (name, swing) in cases {
        let cut = Cut::document(swing);
        let found = cut.polygon().flatness.in_um();
        let expected = cut.flatness_um(0.0, PI / 4.0);
        println!("{name}: {found:.3} µm, by brute force {expected:.3} µm");
        near(found, expected, 0.1);
    }
}

/// N = 3 on the same axes: a hexagon, whose corner stands at 30°.
#[test]
fn the_documents_hexagons_are_measured_to_a_tenth_of_a_micrometre() {
    type Swing = fn(f64) -> [f64; 3];
    let cases: [(&str, Swing); 3] = [
        ("none", |_| [0.0; 3]),
        ("X 0.01", |t| [0.01 * 10.0 * (1.0 - (6.0 * t).cos()), 0.0, 0.0]),
        ("Y 0.04", |t| [0.0, 0.04 * 10.0 * (6.0 * t).sin(), 0.0]),
    ];
    for (name, swing) in cases {
        let inserts = vec![0.0, 1.0 / 3.0, 2.0 / 3.0];
        let cut = Cut { inserts, ..Cut::document(swing) };
        let found = cut.polygon().flatness.in_um();
        let expected = cut.flatness_um(0.0, PI / 6.0);
        println!("{name}: {found:.3} µm, by brute force {expected:.3} µm");
        near(found, expected, 0.1);
    }
}

#[test]
fn a_nose_leaves_the_lay_of_the_feed() {
    let cut = Cut { nose: 0.8, ..Cut::hexagon() };
    near(cut.polygon().lay.in_um(), 0.1_f64.powi(2) / (8.0 * 0.8) * 1e3, 0.05);
}

#[test]
fn a_phase_that_lags_tilts_every_facet() {
    // the tool a hundredth of a degree late and the work where it was: the facets stand otherwise
    let polygon = Cut { swing: |_| [0.0, 0.0, -0.1 / 360.0], ..Cut::hexagon() }.polygon();
    // R·θ + phase whole: the contact comes Δ/R later, so the normal stands Δ/R further back
    near(polygon.tilt.in_deg(), -0.05, 0.001);
}

#[test]
fn two_and_a_half_to_one_is_a_pentagon() {
    let cut = Cut {
        inserts: vec![0.0],
        ratio: Ratio { follower: 5, master: 2 },
        radius: 20.0,
        centres: 30.0,
        stock: 15.0,
        ..Cut::hexagon()
    };
    let polygon = cut.polygon();
    assert_eq!(polygon.sides, 5);
    near(polygon.corner_angle.in_deg(), 108.0, 1e-3);
    let expected = cut.flatness_um(0.0, PI / 5.0);
    near(polygon.flatness.in_um(), expected, 0.1);
}

#[test]
fn a_taper_is_judged_at_every_height_and_as_a_slope() {
    // a tenth of a millimetre of X in a millimetre of Z: across flats twice that
    let cut = Cut { taper: 0.1, ..Cut::hexagon() };
    let polygon = cut.polygon();
    near(polygon.along.across_flats.value(), 0.2, 1e-3);
    near(polygon.along_ordered.across_flats.value(), 0.2, 1e-9);
    near(polygon.along.turn.in_deg(), 0.0, 1e-3);
    assert!((polygon.flatness.in_um() - 8.7).abs() < 0.3, "{}", polygon.flatness.in_um());
    assert!(cut.judged().verdict.reason().is_none(), "{:?}", cut.judged().verdict);
    let (first, last) = (&polygon.sections[0], &polygon.sections[8]);
    let wider = (first.facets[0].distance - last.facets[0].distance).value();
    near(wider, 0.1 * (first.z - last.z).value(), 2e-4);
}

#[test]
fn a_ratio_that_winds_is_a_twisted_polygon() {
    // 3600:7201 winds by 360°/7200 a turn, 0.05°; at 0.1 mm a turn 0.5° a millimetre. Z falls while
    // the facets turn on.
    let ratio = Ratio { follower: 7201, master: 3600 };
    let cut = Cut { ratio, nose: 0.8, ..Cut::hexagon() };
    let polygon = cut.polygon();
    assert_eq!(polygon.sides, 6);
    near(polygon.along.turn.in_deg(), -0.5, 0.002);
    near(polygon.along_ordered.turn.in_deg(), -0.5, 1e-3);
    near(polygon.tilt.in_deg(), 0.0, 0.01);
    // each pass stands 0.05° on from the one before: half of that at the corner, 4.907 mm out,
    // adds 2.14 µm
    near(polygon.flatness.in_um(), 8.7 + 2.14, 0.3);
    // the same gear with a tool that runs away from it by as much again: as wide, but not as
    // twisted as ordered
    let wrong =
        Cut { ratio, nose: 0.8, swing: |work| [0.0, 0.0, work / TAU / 3600.0], ..Cut::hexagon() };
    let polygon = wrong.polygon();
    near(polygon.along.turn.in_deg(), -1.0, 0.01);
    near(polygon.along_ordered.turn.in_deg(), -0.5, 0.001);
    assert!(wrong.judged().verdict.reason().unwrap().contains("tilted"));
}

#[test]
fn inserts_at_a_right_angle_give_a_rhombus() {
    let cut = Cut { inserts: vec![0.0, 0.25], stock: 30.0, ..Cut::hexagon() };
    let polygon = cut.polygon();
    assert_eq!(polygon.sides, 4);
    // its facets bulge, and lie to one side of where they are cut: their zones incline a little
    near(polygon.corner_angle.in_deg(), 45.0, 1.0);
    assert_eq!(polygon.name(), "rhombus 17.000");
}

#[test]
fn a_polygon_that_was_never_cut_fails_and_says_so() {
    let mut cut = Cut::hexagon();
    cut.centres = 90.0;
    let feature = cut.judged();
    assert!(
        feature.verdict.reason().unwrap().contains("never touched the stock"),
        "{:?}",
        feature.verdict
    );
}

#[test]
fn a_polygon_whose_program_has_its_zero_elsewhere_fails() {
    for zero_off in [[5.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, -5.0]] {
        let feature = Cut { zero_off, ..Cut::hexagon() }.judged();
        let reason = feature.verdict.reason().unwrap_or_default();
        assert!(reason.contains("off the work's along"), "{zero_off:?}: {reason}");
    }
}

#[test]
fn a_cutter_that_passes_beside_the_bar_has_cut_nothing() {
    let feature = Cut { centres: 65.0, ..Cut::hexagon() }.judged();
    let reason = feature.verdict.reason().unwrap_or_default();
    assert!(reason.contains("not cut: the cutter never touched the stock"), "{reason}");
    assert!(!feature.contact.is_cut());
}

/// What is cut first and then: width, angle of the cutter, length; what is to be said of the two.
type Over = (&'static str, [(f64, f64, u32); 2], [Option<&'static str>; 2]);

#[test]
fn polygons_over_one_another_are_judged_by_what_both_leave() {
    let flat = |across: f64, phase_deg: f64| Cut {
        centres: 50.0 + across / 2.0,
        phase: phase_deg / 360.0,
        ..Cut::hexagon()
    };
    let whole = STEPS;
    let cut_off = |n: u32| match n {
        1 => Some("good when cut, destroyed in line 7: hexagon"),
        _ => Some("line 2 has cut its corners"),
    };
    let cases: [Over; 12] = [
        ("a spring pass", [(17.0, 0.0, whole), (17.0, 0.0, whole)], [None, None]),
        (
            "a third of the cutter on: the same faces",
            [(17.0, 0.0, whole), (17.0, 120.0, whole)],
            [None, None],
        ),
        ("roughing", [(18.0, 0.0, whole), (17.0, 0.0, whole)], [None, None]),
        (
            "roughing at another angle, far enough out",
            [(19.2, 60.0, whole), (17.0, 0.0, whole)],
            [None, None],
        ),
        ("a smaller one on its end", [(19.0, 0.0, whole), (15.0, 0.0, whole / 2)], [None, None]),
        (
            "a larger one where a smaller one was",
            [(17.0, 0.0, whole), (18.0, 0.0, whole)],
            [None, Some("µm deeper before it")],
        ),
        ("15° of the work on", [(17.0, 0.0, whole), (17.0, 30.0, whole)], [cut_off(1), cut_off(2)]),
        ("30° of the work on", [(17.0, 0.0, whole), (17.0, 60.0, whole)], [cut_off(1), cut_off(2)]),
        ("5° of the work on", [(17.0, 0.0, whole), (17.0, 10.0, whole)], [cut_off(1), cut_off(2)]),
        (
            "half as long, 15° on",
            [(17.0, 0.0, whole), (17.0, 30.0, whole / 2)],
            [cut_off(1), cut_off(2)],
        ),
        (
            "roughing at another angle, too deep",
            [(18.6, 60.0, whole), (17.0, 0.0, whole)],
            [cut_off(1), cut_off(2)],
        ),
        (
            "a larger one over it at another angle",
            [(17.0, 0.0, whole), (18.6, 60.0, whole)],
            [cut_off(1), cut_off(2)],
        ),
    ];
    for (name, [first, then], expected) in cases {
        let cuts = [first, then].map(|(across, phase, steps)| (flat(across, phase), steps));
        let features = over(&cuts.each_ref().map(|(cut, steps)| (cut, *steps)));
        let said: Vec<_> = features.iter().map(|feature| feature.verdict.reason()).collect();
        println!("{name}: {said:?}");
        for (said, expected) in said.iter().zip(expected) {
            let agree = match (said, expected) {
                (Some(said), Some(expected)) => said.contains(expected),
                (said, expected) => said.is_none() && expected.is_none(),
            };
            assert!(agree, "{name}: {said:?}, expected {expected:?}");
        }
    }
}

//! What the document says, and what is beyond it.
use crate::fine;
use forms::polygon::{
    Actuator, Detail, Drive, Effort, Form, Limits, Problem, Solution, Swings, insert_phases,
};
use units::{Angle, Length, Spin};

fn hexagon() -> Form {
    Form {
        inserts: insert_phases(3),
        turns: [2, 1],
        across_flats: Length::mm(17.0),
        tip_radius: Length::mm(50.0),
        stock_radius: Length::mm(12.0),
    }
}

/// N = 2, l = 10, r = 5.
fn document() -> Form {
    Form {
        inserts: insert_phases(2),
        turns: [2, 1],
        across_flats: Length::mm(10.0),
        tip_radius: Length::mm(5.0),
        stock_radius: Length::mm(12.0),
    }
}

fn free(actuator: Actuator) -> Drive {
    let limits = Limits {
        travel: f64::INFINITY,
        speed: f64::INFINITY,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
        effort: None,
    };
    Drive { actuator, limits, response: Vec::new() }
}

fn solve(form: &Form, drives: Vec<Drive>, harmonics: usize) -> Solution {
    Problem { form, spin: Spin::rpm(500.0), drives, harmonics }.solve().unwrap()
}

#[test]
fn the_largest_a_without_concavity_is_the_closed_form() {
    type Make = fn(&Form, f64) -> Swings;
    let form = document();
    // aX* = (l−r)/(l·M²), aY* = (l−r)/(2·l·M)
    assert!((form.largest_convex_along() - 5.0 / (10.0 * 16.0)).abs() < 1e-15);
    assert!((form.largest_convex_across() - 5.0 / (2.0 * 10.0 * 4.0)).abs() < 1e-15);
    let height = |swings: &Swings, at: f64| {
        let profile = form.profile(&form.kinds()[0], swings);
        let nearest = profile
            .points
            .iter()
            .min_by(|a, b| (a[0].value() - at).abs().total_cmp(&(b[0].value() - at).abs()));
        nearest.unwrap()[1].value()
    };
    // just below it the middle stands out, just above it is hollow
    let both: [(Make, f64); 2] = [
        (Swings::along_centres, form.largest_convex_along()),
        (Swings::across, form.largest_convex_across()),
    ];
    for (make, a) in both {
        let bulge = |a: f64| height(&make(&form, a), 0.0) - height(&make(&form, a), 0.3);
        assert!(bulge(0.98 * a) > 0.0 && bulge(1.02 * a) < 0.0);
    }
}

#[test]
fn the_flattest_a_is_another_one() {
    let form = document();
    let (convex, (flattest, flat)) = (
        form.largest_convex_along(),
        form.flattest(Swings::along_centres, form.largest_convex_along()),
    );
    assert!(flattest > 1.1 * convex, "{flattest} {convex}");
    let at_convex = form.flatness(&Swings::along_centres(&form, convex));
    assert!(flat.value() < 0.7 * at_convex.value(), "{flat} {at_convex}");
    let (across, _) = form.flattest(Swings::across, form.largest_convex_across());
    assert!(across > 1.01 * form.largest_convex_across());
}

#[test]
fn one_harmonic_each_of_x_and_y_is_flat_to_less_than_a_tenth_of_a_micrometre() {
    let both = solve(&hexagon(), vec![free(Actuator::CentreLine), free(Actuator::Across)], 1);
    assert!(both.flatness.in_um() < 0.1, "{} µm", both.flatness.in_um());
}

#[test]
fn enough_harmonics_are_exactly_flat() {
    for actuator in Actuator::ALL {
        let exact = solve(&hexagon(), vec![free(actuator)], 6);
        assert!(exact.flatness.in_um() < 0.001, "{actuator:?}: {} µm", exact.flatness.in_um());
    }
}

#[test]
fn the_phase_that_the_seed_lacks_is_about_l_less_r_over_two_m_r() {
    let one = solve(&hexagon(), vec![free(Actuator::ToolPhase)], 1);
    let d = one.command.0[0].terms[0].sine * core::f64::consts::TAU;
    let expected = 8.5 / (2.0 * 6.0 * 50.0);
    assert!((d / expected - 1.0).abs() < 0.1, "{d} {expected}");
    assert!(one.flatness.in_um() < 0.3, "{} µm", one.flatness.in_um());
}

fn slide() -> Limits {
    Limits {
        travel: 20.0,
        speed: 200.0,
        acceleration: 8000.0,
        jerk: 500e3,
        effort: Some(Effort {
            per_acceleration: 0.12,
            per_speed: 0.6,
            constant: 150.0,
            most: 9000.0,
        }),
    }
}

/// Everything at a limit: within 2 % of the fine optimum, not better than it, and no peak beyond
/// its limit.
fn near_the_fine_optimum(limits: &Limits, rpm: f64) {
    let form = hexagon();
    let drive =
        Drive { actuator: Actuator::CentreLine, limits: limits.clone(), response: Vec::new() };
    let drives = vec![drive];
    let fine = fine::optimum_um(&form, rpm, &drives);
    let problem = Problem { form: &form, spin: Spin::rpm(rpm), drives, harmonics: 4 };
    let found = problem.solve_well(Detail::Full).unwrap();
    let flat = found.flatness.in_um();
    println!("{rpm} rpm: {flat:.4} µm, fine optimum {fine:.4} µm, {:?}", found.binding);
    assert!(found.binding.is_some(), "nothing binds");
    assert!(flat < 1.02 * fine && flat > 0.995 * fine, "{flat} {fine}");
    let [travel, speed, acceleration, jerk, force] = found.peaks[0];
    assert!(travel <= limits.travel && speed <= limits.speed, "{:?}", found.peaks);
    assert!(acceleration <= limits.acceleration && jerk <= limits.jerk, "{:?}", found.peaks);
    assert!(limits.effort.is_none_or(|e| force <= e.most), "{:?}", found.peaks);
}

#[test]
fn where_jerk_binds_it_is_within_two_percent_of_a_fine_optimum() {
    for rpm in [250.0, 400.0] {
        near_the_fine_optimum(&slide(), rpm);
    }
}

#[test]
fn where_acceleration_binds_too() {
    let limits = Limits { jerk: 20e6, acceleration: 1500.0, effort: None, ..slide() };
    near_the_fine_optimum(&limits, 180.0);
}

#[test]
fn at_their_limits_two_slides_are_flatter_than_either() {
    let form = hexagon();
    let y = Limits { acceleration: 4000.0, jerk: 300e3, ..slide() };
    // as a slide on its screw answers, which swings by itself at 112 Hz: 1/(1 − r² + 0.08·j·r)
    let answer = |h: u32| {
        let r = 50.0 * f64::from(h) / 112.0;
        let (re, im) = (1.0 - r * r, 0.08 * r);
        let size = re * re + im * im;
        [re / size, -im / size]
    };
    let response: Vec<[f64; 2]> = (1..=96).map(answer).collect();
    let drive = |actuator, limits: &Limits| Drive {
        actuator,
        limits: limits.clone(),
        response: response.clone(),
    };
    let solve = |drives| {
        let problem = Problem { form: &form, spin: Spin::rpm(500.0), drives, harmonics: 4 };
        let few = problem.solve().unwrap();
        (few.flatness.in_um(), problem.refined(few, Detail::Full).flatness.in_um())
    };
    let (x, y) = (drive(Actuator::CentreLine, &slide()), drive(Actuator::Across, &y));
    let (only_x, only_y) = (solve(vec![x.clone()]), solve(vec![y.clone()]));
    let both = solve(vec![x, y]);
    println!("X {only_x:?}, Y {only_y:?}, both {both:?} µm");
    assert!(both.1 < 0.98 * only_x.1.min(only_y.1) && both.1 < 0.98 * both.0);
}

#[test]
fn a_loop_that_lags_is_taken_into_account() {
    // gain 0.9, 10° late: commanded so much more and earlier, unless a limit forbids
    let late = (-10_f64).to_radians();
    let lag = [0.9 * late.cos(), 0.9 * late.sin()];
    let plain = solve(&hexagon(), vec![free(Actuator::ToolPhase)], 1);
    let lagging = Drive { response: vec![lag], ..free(Actuator::ToolPhase) };
    let led = solve(&hexagon(), vec![lagging], 1);
    assert!((plain.flatness - led.flatness).in_um().abs() < 0.01);
    let amplitude =
        |s: &Solution| s.command.0[0].terms[0].sine.hypot(s.command.0[0].terms[0].cosine);
    assert!((amplitude(&led) / amplitude(&plain) - 1.0 / 0.9).abs() < 1e-3);
}

#[test]
fn inserts_at_a_right_angle_are_a_rhombus_with_a_series_of_its_own() {
    let form = Form {
        inserts: vec![Angle::ZERO, Angle::rev(0.25)],
        stock_radius: Length::mm(25.0),
        ..hexagon()
    };
    let facets = form.facets();
    assert_eq!(facets.len(), 4);
    assert_eq!(form.base(), 2.0);
    assert!((facets[0].to.value() - facets[0].from.value().abs()).abs() > 1.0, "{facets:?}");
    let none = form.flatness(&Swings::default());
    let swung = solve(&form, vec![free(Actuator::ToolPhase)], 12);
    assert!(swung.flatness.value() < 0.02 * none.value(), "{} {none}", swung.flatness);
}

#[test]
fn a_pentagon_at_five_to_two_is_flat_by_its_radius_alone() {
    let mut form = Form { inserts: insert_phases(1), turns: [5, 2], ..hexagon() };
    assert_eq!(form.facets().len(), 5);
    // r = l/(R−1)², l = AF/2 + r
    form.tip_radius = Length::mm(8.5 / (1.5_f64.powi(2) - 1.0));
    let natural = form.flatness(&Swings::default());
    form.tip_radius = form.tip_radius * 2.0;
    let other = form.flatness(&Swings::default());
    assert!(natural.value() < 0.2 * other.value(), "{natural} {other}");
}

#[test]
fn two_flats_end_at_the_bar() {
    let form = Form { inserts: insert_phases(1), ..hexagon() };
    let facets = form.facets();
    assert_eq!(facets.len(), 2);
    assert!((facets[0].to.value() - (12.0_f64.powi(2) - 8.5_f64.powi(2)).sqrt()).abs() < 1e-9);
}

#[test]
fn what_cannot_be_cut_is_refused_with_what_works() {
    let said = |form: Form| {
        form.check().unwrap_err().iter().map(|r| r.0.clone()).collect::<Vec<_>>().join("; ")
    };
    assert!(said(Form { turns: [-2, 1], ..hexagon() }).contains("1:2, works"));
    assert!(said(Form { turns: [1, 1], ..hexagon() }).contains("1:2 works"));
    assert!(
        said(Form { stock_radius: Length::mm(9.0), ..hexagon() })
            .contains("19.630 mm across corners")
    );
    assert!(said(Form { inserts: vec![], ..hexagon() }).contains("no insert"));
    // 2.35 is 7:3 and a sixtieth; of gears of at most eight turns and 64 facets none is nearer
    let odd = said(Form { turns: [235, 100], ..hexagon() });
    assert!(odd.contains("141 different facets") && odd.contains("3:7 works"), "{odd}");
    // l + r = 8.5 + 2·6.8 = 22.1, in a bar of 25
    let inside = Form {
        inserts: insert_phases(1),
        turns: [5, 2],
        tip_radius: Length::mm(6.8),
        stock_radius: Length::mm(25.0),
        ..hexagon()
    };
    assert!(said(inside.clone()).contains("above 8.251 mm works, or a bar below Ø44.200"));
    Form { stock_radius: Length::mm(22.0), ..inside }.check().unwrap();
}

/// An ellipse with half-axes l − r and l + r, from its vertex to the corner.
#[test]
fn what_is_left_without_a_swing_is_what_the_ellipse_says() {
    let form = hexagon();
    let cut = form.cut(&Swings::default()).unwrap();
    // x²/8.5² + y²/108.5² = 1 on the ray at 30°
    let (sine, cosine) = 30_f64.to_radians().sin_cos();
    let corner = cosine / (cosine / 8.5_f64).hypot(sine / 108.5);
    assert!((cut.flatness.value() - (8.5 - corner)).abs() < 1e-6, "{cut:?}");
    assert!((cut.across_flats.value() - (8.5 + corner)).abs() < 1e-6, "{cut:?}");
    assert!(cut.tilt.in_deg().abs() < 1e-9);
}

#[test]
fn a_tip_that_cuts_into_another_ones_facet_is_seen() {
    // eight times a turn X comes to where it belongs at a facet, four times with an insert between
    // two of them
    let form = document();
    let dip = Swings(vec![forms::polygon::Series {
        actuator: Actuator::CentreLine,
        terms: vec![
            forms::polygon::Term { per_turn: 8.0, cosine: 1.0, sine: 0.0 },
            forms::polygon::Term { per_turn: 0.0, cosine: -1.0, sine: 0.0 },
        ],
    }]);
    let seen = form.cut(&dip).unwrap().flatness;
    assert!(seen > Length::um(200.0), "{seen}");
}

/// The size is part of what is solved: whatever swings, the facets come out flat at the size that
/// was asked, by the exact kinematics of all inserts.
#[test]
fn every_form_comes_out_flat_at_the_size_that_was_asked() {
    let sets: [&[Actuator]; 6] = [
        &[Actuator::CentreLine],
        &[Actuator::Across],
        &[Actuator::ToolPhase],
        &[Actuator::CentreLine, Actuator::Across],
        &[Actuator::CentreLine, Actuator::ToolPhase],
        &Actuator::ALL,
    ];
    let forms: [(f64, f64, Vec<Angle>, [i32; 2]); 6] = [
        (30.0, 50.0, insert_phases(2), [2, 1]),
        (10.0, 5.0, insert_phases(2), [2, 1]),
        (17.0, 50.0, insert_phases(3), [2, 1]),
        (17.0, 50.0, vec![Angle::ZERO, Angle::rev(0.25)], [2, 1]),
        (17.0, 50.0, insert_phases(1), [5, 2]),
        (12.0, 30.0, insert_phases(4), [2, 1]),
    ];
    for (size, radius, inserts, turns) in forms {
        let form = Form {
            inserts,
            turns,
            across_flats: Length::mm(size),
            tip_radius: Length::mm(radius),
            stock_radius: Length::mm(25.0),
        };
        for who in sets {
            let harmonics = if form.is_regular() { 6 } else { 16 };
            let found = solve(&form, who.iter().map(|a| free(*a)).collect(), harmonics);
            let cut = form.cut(&found.actual).unwrap();
            let claimed = found.flatness.in_um();
            println!("{size} mm by {radius}: {who:?} {claimed:.4} µm claimed, {cut:?}");
            assert!(cut.flatness.in_um() <= claimed + 0.01, "{cut:?} {claimed}");
            let off = (cut.across_flats - form.across_flats).in_um().abs();
            assert!(off <= claimed + 0.01, "{off} {claimed}");
        }
    }
}

//! The watch over a run, on signals made up for it.
use super::*;
use canon::{Position, Span};
use units::{Coordinate, CoordinateSpeed};

/// A hole 20 mm deep, drilled at this spindle speed, rpm, where 5000 is in force.
fn breaches(rpm: f64, to_mm: f64) -> Vec<String> {
    breaches_in_line(0, rpm, to_mm)
}

/// The same, while a block of some line is in work; the hole's is line 0.
fn breaches_in_line(line: u32, rpm: f64, to_mm: f64) -> Vec<String> {
    breaches_of(SpindleOrder::Turn(Spin::rpm(5000.0)), line, rpm, to_mm)
}

fn breaches_of(order: SpindleOrder, line: u32, rpm: f64, to_mm: f64) -> Vec<String> {
    let watch = watched(order, line, rpm, to_mm);
    watch.breaches().iter().map(|breach| breach.what.clone()).collect()
}

fn watched(order: SpindleOrder, line: u32, rpm: f64, to_mm: f64) -> Watch {
    let mut watch = Watch::new(Config::new(canon::ToolLibrary::new([])));
    let op = |kind| Op { kind, span: Span::default() };
    watch.op(0, &op(OpKind::Spindle { spindle: 0, order }));
    let hole = canon::Hole {
        axis: Axis::Z,
        at: Position::xyz(0.0, 0.0, 5.0),
        bottom: Length::mm(-20.0),
        surface: Length::ZERO,
        zero: Length::ZERO,
        own_zero: None,
    };
    watch.op(1, &op(OpKind::Hole(hole)));
    let mut sample = Sample::default();
    (sample.report.op, sample.report.line, sample.report.state) = (2, line, State::Feed);
    let feed = CoordinateSpeed::new(50.0);
    while sample.feedback.axes[2].position.value() > to_mm {
        sample.feedback.time += Time::s(1e-3);
        sample.feedback.spindles[0].angle += Spin::rpm(rpm) * Time::s(1e-3);
        sample.feedback.axes[2].position -= feed * Time::s(1e-3);
        watch.sample(&sample);
    }
    watch
}

#[test]
fn a_program_has_its_own_breaches_and_none_of_the_program_before_it() {
    let ordered = SpindleOrder::Turn(Spin::rpm(5000.0));
    let mut watch = watched(ordered, 0, 3000.0, -20.0);
    assert_eq!(watch.breaches().len(), 1);
    let first = watch.clone().of_program();
    assert_eq!((first.breaches().len(), first.violations()), (1, watch.violations()));
    watch.begin_program();
    let good = Sample::default();
    watch.sample(&good);
    assert_eq!(watch.breaches().len(), 1, "the work has seen it");
    let second = watch.of_program();
    assert_eq!((second.periods(), second.violations()), (1, 0));
    assert!(second.breaches().is_empty());
}

/// A tool that the program before has broken is broken in this one too: it is said again.
#[test]
fn what_goes_on_into_the_next_program_is_its_breach_too() {
    let mut watch = watched(SpindleOrder::Stop, 0, 0.0, 0.0);
    let truth = bus::Truth { tool_broken: true, ..bus::Truth::default() };
    let broken = Sample { truth: Some(truth), ..Sample::default() };
    watch.sample(&broken);
    assert_eq!(watch.breaches().len(), 1);
    watch.begin_program();
    watch.sample(&broken);
    watch.sample(&broken);
    let own = watch.of_program();
    assert_eq!((own.breaches().len(), own.violations()), (1, 2));
}

#[test]
fn a_hole_in_the_axis_of_the_work_is_drilled_at_the_limit_of_the_surface_speed() {
    let order = SpindleOrder::ConstantSurfaceSpeed {
        speed: Speed::mm_per_min(100_000.0),
        limit: Some(Spin::rpm(2000.0)),
    };
    assert_eq!(breaches_of(order, 0, 1950.0, -20.0), Vec::<String>::new());
    assert_eq!(breaches_of(order, 0, 1000.0, -20.0).len(), 1);
    assert_eq!(breaches_of(order, 0, 3000.0, -20.0).len(), 1);
}

#[test]
fn a_hole_drilled_as_ordered_breaks_nothing() {
    assert_eq!(breaches(4990.0, -20.0), Vec::<String>::new());
}

/// M6 at 3000 rpm, fed in by its helix but for `lag_mm` that the axis runs on after the spindle has
/// turned back.
fn tapped(lag_mm: f64) -> Vec<String> {
    let tap = canon::TapTool {
        designation: "M6x1".into(),
        lead: units::Lead::mm_per_rev(1.0),
        chamfer_pitches: 2.5,
        thread_length: Length::mm(30.0),
        flute: canon::Flute::SpiralFlute,
        oversize: Length::ZERO,
        holder: Holder::Rigid { stiffness: units::Stiffness::n_per_mm(20_000.0) },
        max_torque: None,
    };
    let tool = canon::Tool {
        number: 1,
        pocket: 1,
        length: Length::ZERO,
        diameter: Length::mm(6.0),
        kind: ToolKind::Tap(tap),
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    };
    let mut watch = Watch::new(Config::new(canon::ToolLibrary::new([tool])));
    let op = |kind| Op { kind, span: Span::default() };
    watch.op(0, &op(OpKind::ChangeTool { number: 1 }));
    let spin = Spin::rpm(3000.0);
    watch.op(
        1,
        &op(OpKind::Tap(canon::Tap {
            axis: Axis::Z,
            start: Position::xyz(0.0, 0.0, 5.0),
            bottom: Length::mm(-10.0),
            surface: Length::ZERO,
            zero: Length::ZERO,
            own_zero: None,
            lead: units::Lead::mm_per_rev(1.0),
            spin,
            return_spin: spin,
            return_acceleration: canon::ReturnAcceleration::AsSet,
            dwell: Time::ZERO,
            start_angle: None,
            peck: None,
        })),
    );
    let mut sample = Sample::default();
    (sample.report.op, sample.report.state) = (1, State::TapIn);
    sample.feedback.tool = Some(1);
    let step = Length::mm(0.0025);
    let mut at = |spindle_mm: f64, axis_mm: f64| {
        sample.feedback.time += Time::s(1e-3);
        sample.feedback.spindles[0].angle = Angle::rev(-spindle_mm);
        sample.feedback.axes[2].position = Coordinate::new(axis_mm);
        watch.sample(&sample);
    };
    let steps =
        |mm: f64| (0..).map(move |k| f64::from(k) * step.value()).take_while(move |s| *s < mm);
    steps(15.0).for_each(|s| at(5.0 - s, 5.0 - s)); // in
    steps(lag_mm).for_each(|s| at(-10.0 + s, -10.0 - s)); // the spindle turns back, the axis goes on
    steps(10.0).for_each(|s| at(-10.0 + lag_mm + s, -10.0 - lag_mm + s));
    watch.breaches().iter().map(|breach| breach.what.clone()).collect()
}

#[test]
fn a_tap_driven_against_its_helix_is_seen_and_a_moment_at_the_turning_point_is_none() {
    assert_eq!(tapped(0.0), Vec::<String>::new());
    assert_eq!(tapped(AGAINST_MM / 2.0), Vec::<String>::new());
    let seen = tapped(5.0 * AGAINST_MM);
    assert_eq!(seen, ["the spindle turns against the tap's way in the material"]);
}

#[test]
fn what_another_block_does_is_not_held_against_the_hole() {
    // another tool of another length, another pocket: deeper is none of the hole's business
    assert_eq!(breaches_in_line(7, 5000.0, -60.0), Vec::<String>::new());
}

#[test]
fn a_cut_in_reverse_or_too_slow_or_too_deep_is_seen_once() {
    assert_eq!(breaches(-2000.0, -20.0).len(), 1);
    assert_eq!(breaches(3000.0, -20.0).len(), 1);
    assert_eq!(breaches(5000.0, -20.2), ["the tip is beyond the programmed bottom"]);
}

//! Inserts against the bar of a lathe, before motion: a rapid goes only where the program has
//! turned the bar away.
use crate::common;
use crate::common::{change, line, machine, mm, program, rapid, turn};
use canon::{
    Body, Feed, Insert, LengthUnit, OpKind, Position, ProgramFrame, Threading, Tool, ToolKind,
    ToolLibrary,
};
use plan::{Bar, Planner, Start, Stock};
use units::{Angle, Lead, LeadGrowth, Length};

/// 20 mm, its face at Z0 of G54, which is Z-200 of the machine.
const FACE: f64 = -200.0;
const STOCK: Stock = Stock {
    from: [Length::mm(-10.0), Length::mm(-10.0), Length::mm(FACE - 120.0)],
    to: [Length::mm(10.0), Length::mm(10.0), Length::mm(FACE)],
    zero: Length::mm(FACE),
    bar: Some(Bar { radius: Length::mm(10.0), bore: Length::ZERO }),
};

fn tools() -> ToolLibrary {
    let mut tools = ToolLibrary::default();
    let insert = Insert::turning(Angle::deg(80.0), mm(0.4));
    let tool = |number, diameter, kind| Tool {
        number,
        pocket: number,
        length: mm(60.0),
        diameter: mm(diameter),
        kind,
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    };
    tools.insert(tool(1, 0.0, ToolKind::Insert(insert)));
    // a boring bar of 7 mm that stands 25 mm out, and a grooving tool that stands 2 mm over a shank
    // of 12 mm
    let bar = Body { shank: Some(mm(7.0)), stick_out: Some(mm(25.0)), ..Body::default() };
    tools.insert(Tool { body: bar, ..tool(3, 0.0, ToolKind::Insert(insert)) });
    let thick = Body { shank: Some(mm(10.0)), ..bar };
    tools.insert(Tool { body: thick, ..tool(4, 0.0, ToolKind::Insert(insert)) });
    let groove = Body { shank: Some(mm(12.0)), stick_out: Some(mm(2.0)), ..Body::default() };
    tools.insert(Tool { body: groove, ..tool(5, 0.0, ToolKind::Insert(insert)) });
    tools.insert(tool(2, 8.0, ToolKind::Drill { point_angle: Angle::deg(118.0) }));
    tools
}

/// Findings of a program in diameters, on a bar of 20 mm.
fn said(kinds: impl IntoIterator<Item = OpKind>) -> String {
    said_in(LengthUnit::Millimetre, "M0360", kinds)
}

fn said_in(unit: LengthUnit, code: &str, kinds: impl IntoIterator<Item = OpKind>) -> String {
    let start = Start { position: Position::xyz(100.0, 0.0, -10.0), tool: 0 };
    let planner = Planner::new(machine(), tools(), common::OPTIONS, start);
    let mut planner = planner.turning_work().with_stock(STOCK).only_judging();
    planner.written_in(ProgramFrame {
        work_offset: 1,
        origin: Position::xyz(0.0, 0.0, FACE),
        tool: Position::xyz(0.0, 0.0, 60.0),
        x_is_diameter: true,
        unit,
        ..ProgramFrame::default()
    });
    for (index, op) in (0..).zip(&program(kinds)) {
        planner.push(index, op, &mut |_| ());
    }
    planner.finish(&mut |_| ());
    let found = planner.take_findings();
    found.iter().filter(|d| d.code == code).fold(String::new(), |all, d| {
        format!("{all}{:?} line {}: {}\n", d.severity, d.span.line, d.message)
    })
}

/// A rapid to a diameter and a Z of the program; the same as a cut.
fn to(x: f64, z: f64) -> OpKind {
    rapid(x / 2.0, 0.0, FACE + 60.0 + z)
}

fn cut(x: f64, z: f64) -> OpKind {
    line(x / 2.0, 0.0, FACE + 60.0 + z, 100.0)
}

fn with_insert(kinds: impl IntoIterator<Item = OpKind>) -> String {
    said([change(1), turn(800.0)].into_iter().chain(kinds))
}

#[test]
fn a_rapid_through_a_shoulder_is_refused_with_the_diameter_that_is_clear() {
    let roughed = [to(30.0, 2.0), to(16.0, 2.0), cut(16.0, -30.0), cut(24.0, -30.0)];
    let shoulder = [to(24.0, 2.0), to(16.0, 2.0), to(16.0, -45.0)];
    let text = with_insert(roughed.into_iter().chain(shoulder));
    assert!(text.starts_with("Error line 9: the rapid takes T1 (an insert of a lathe) 2 mm deep into the bar, which it enters at X16 of G54 (a diameter) and Z-3"), "{text}");
    assert!(text.contains("the bar is there up to X20: X24 or more is clear of it"), "{text}");
}

#[test]
fn rapids_where_the_bar_was_turned_away_are_not_said() {
    let pass = |x: f64| [to(x, 2.0), cut(x, -30.0), cut(x + 2.0, -29.0), to(x + 2.0, 2.0)];
    let passes = [18.0, 16.0, 14.0].into_iter().flat_map(pass);
    let face = [to(30.0, 5.0), to(30.0, -1.0), cut(-1.0, -1.0), to(-1.0, 2.0), to(30.0, 2.0)];
    let finish = [to(14.0, 2.0), to(14.0, -28.0), cut(14.0, -30.0), to(60.0, 100.0)];
    assert_eq!(with_insert(face.into_iter().chain(passes).chain(finish)), "");
}

#[test]
fn a_thread_is_open_for_another_pass_and_the_way_out_and_for_nothing_else() {
    let thread = |x: f64| {
        OpKind::Threading(Threading {
            to: Position::xyz(x / 2.0, 0.0, FACE + 60.0 - 25.0),
            lead: Lead::mm_per_rev(1.5),
            growth: LeadGrowth::ZERO,
            start_angle: Angle::ZERO,
            axis: canon::Axis::Z,
            surface: Length::mm(FACE + 60.0),
        })
    };
    let before = [to(30.0, 6.0), to(18.2, 6.0), thread(18.2), to(30.0, -25.0), to(30.0, 6.0)];
    let after = |rest: [OpKind; 2]| with_insert(before.clone().into_iter().chain(rest));
    assert_eq!(after([to(18.2, 6.0), thread(18.2)]), "");
    assert_eq!(after([to(20.2, 6.0), to(20.2, -20.0)]), "");
    let over_its_crests = after([to(18.2, 6.0), to(18.2, -20.0)]);
    assert!(over_its_crests.contains("0.9 mm deep into the bar"), "{over_its_crests}");
    let plunging = after([to(30.0, -6.0), to(18.2, -6.0)]);
    assert!(plunging.contains("0.9 mm deep into the bar"), "{plunging}");
    let deeper = after([to(16.0, 6.0), to(16.0, -20.0)]);
    assert!(deeper.contains("2 mm deep into the bar"), "{deeper}");
}

/// The bar is of 20 mm.
#[test]
fn a_thread_whose_passes_all_stay_off_the_bar_cuts_nothing() {
    let pass = |x: f64, z: f64| {
        let thread = OpKind::Threading(Threading {
            to: Position::xyz(x / 2.0, 0.0, FACE + 60.0 + z),
            lead: Lead::mm_per_rev(1.5),
            growth: LeadGrowth::ZERO,
            start_angle: Angle::ZERO,
            axis: canon::Axis::Z,
            surface: Length::mm(FACE + 60.0),
        });
        [to(x, 6.0), thread, to(30.0, z), to(30.0, 6.0)]
    };
    let said = |passes: &[(f64, f64)]| {
        let passes = passes.iter().flat_map(|(x, z)| pass(*x, *z));
        let begin = [change(1), turn(800.0), to(30.0, 6.0)];
        said_in(LengthUnit::Millimetre, "M0366", begin.into_iter().chain(passes))
    };
    assert_eq!(
        said(&[(22.0, -20.0), (21.0, -20.0)]),
        "Warning line 5: T1 (an insert of a lathe) passes the bar, whose surface is at X20, 0.5 mm off it: nothing is cut here\n"
    );
    // passes begin in the air, and are of one thread
    assert_eq!(said(&[(21.0, -20.0), (19.0, -20.0)]), "");
    let text = said(&[(21.0, -20.0), (19.0, -40.0)]);
    assert!(text.contains("line 5") && text.contains("0.5 mm off it"), "{text}");
    // the way in before the face and the way out of the bar are of the pass
    let stretch = |x: f64, z: f64| {
        OpKind::Threading(Threading {
            to: Position::xyz(x / 2.0, 0.0, FACE + 60.0 + z),
            lead: Lead::mm_per_rev(1.5),
            growth: LeadGrowth::ZERO,
            start_angle: Angle::ZERO,
            axis: canon::Axis::Z,
            surface: Length::mm(FACE + 60.0),
        })
    };
    let tapered =
        |x: f64| [to(30.0, 6.0), stretch(x, 3.0), stretch(x, -18.0), stretch(22.0, -20.0)];
    let passes = |depths: [f64; 2]| {
        let kinds =
            [change(1), turn(800.0)].into_iter().chain(depths.into_iter().flat_map(tapered));
        said_in(LengthUnit::Millimetre, "M0366", kinds.chain([to(30.0, -20.0)]))
    };
    assert_eq!(passes([21.0, 19.0]), "");
    assert!(passes([21.6, 21.0]).contains("0.5 mm off it"));
    let before = said(&[(19.0, 1.0)]);
    assert!(before.contains("stays before the bar's face at Z0"), "{before}");
}

#[test]
fn a_drilled_hole_is_open_for_a_boring_tool() {
    let hole = [to(0.0, 2.0), cut(0.0, -40.0), to(0.0, 50.0)];
    let bore = [change(1), turn(800.0), to(6.0, 2.0), to(6.0, -30.0), to(6.0, 50.0)];
    let drilled = [change(2), turn(800.0)].into_iter().chain(hole).chain(bore.clone());
    assert_eq!(said(drilled), "");
    assert!(said(bore).starts_with("Error line 4"));
}

/// As Fanuc's G76 with a tool table in which T2 is a drill.
#[test]
fn a_drill_beside_the_axis_of_a_turning_bar_is_refused_and_at_rest_it_is_not() {
    let thread = |x: f64| {
        OpKind::Threading(Threading {
            to: Position::xyz(x / 2.0, 0.0, FACE + 60.0 - 20.0),
            lead: Lead::mm_per_rev(1.5),
            growth: LeadGrowth::ZERO,
            start_angle: Angle::ZERO,
            axis: canon::Axis::Z,
            surface: Length::mm(FACE + 60.0),
        })
    };
    let turned = |kinds: Vec<OpKind>| said_in(LengthUnit::Millimetre, "M0361", kinds);
    let text = turned(vec![change(2), turn(800.0), to(18.2, 6.0), thread(18.2)]);
    assert!(text.starts_with("Error line 4: T2 (a drill) goes 0.9 mm deep into the turning bar, 9.1 mm beside the bar's axis, and cuts on that axis only: X0 works"), "{text}");
    let text = turned(vec![change(2), turn(800.0), to(12.0, 6.0), cut(12.0, -10.0)]);
    assert!(text.starts_with("Error line 4"), "{text}");
    // a pass in the air leaves no bore, and the next one is no less deep
    let passes = [to(20.6, 6.0), thread(20.6), to(30.0, 6.0), to(19.4, 6.0), thread(19.4)];
    let text = turned([change(2), turn(800.0)].into_iter().chain(passes).collect());
    assert!(text.starts_with("Error line 7: T2 (a drill) goes 0.3 mm deep"), "{text}");
    // on its axis, in the air, and a driven tool in a bar that stands
    assert_eq!(turned(vec![change(2), turn(800.0), to(0.0, 6.0), cut(0.0, -10.0)]), "");
    assert_eq!(turned(vec![change(2), turn(800.0), to(24.0, 6.0), cut(24.0, -10.0)]), "");
    assert_eq!(turned(vec![change(2), to(12.0, 6.0), cut(12.0, -10.0)]), "");
}

#[test]
fn a_feed_is_never_said() {
    let feed = Feed::PerRevolution(Lead::mm_per_rev(0.2));
    let deep = OpKind::Line { to: Position::xyz(2.0, 0.0, FACE + 30.0), feed };
    assert_eq!(with_insert([to(30.0, 2.0), deep]), "");
}

/// 0.7874 in are 20 mm: 0.2 in more on the diameter is clear, rounded outward.
#[test]
fn in_inches_the_diameter_that_is_clear_is_rounded_outward() {
    let inside = [to(24.0, 2.0), to(16.0, 2.0), to(16.0, -45.0)];
    let text =
        said_in(LengthUnit::Inch, "M0360", [change(1), turn(800.0)].into_iter().chain(inside));
    assert!(text.contains("0.0787 in deep into the bar"), "{text}");
    assert!(text.contains("up to X0.7874: X0.9875 or more is clear of it"), "{text}");
    let works = text.split(": X").nth(1).and_then(|rest| rest.split(' ').next());
    let works: f64 = works.and_then(|word| word.parse().ok()).expect("a diameter");
    let again = [to(24.0, 2.0), to(works * 25.4, 2.0), to(works * 25.4, -45.0)];
    assert_eq!(with_insert(again), "");
    assert!(works * 25.4 >= 20.0 + 2.0 * 2.54, "{works}");
}

#[test]
fn a_boring_bar_fits_into_its_bore_and_its_holder_stays_before_the_face() {
    let drilled = [change(2), turn(800.0), to(0.0, 2.0), cut(0.0, -40.0), to(0.0, 50.0)];
    let bored = |tool, z| {
        let bore =
            [change(tool), turn(800.0), to(8.4, 2.0), cut(8.4, z), to(7.0, z), to(7.0, 50.0)];
        said_in(LengthUnit::Millimetre, "M0367", drilled.clone().into_iter().chain(bore))
    };
    assert_eq!(bored(3, -20.0), "");
    let deep = bored(3, -30.0);
    assert!(
        deep.contains("stands 25 mm out of its holder")
            && deep.contains(": Z-25 is the deepest that works"),
        "{deep}"
    );
    let thick = bored(4, -20.0);
    assert!(
        thick.contains(
            "the bar of T4 (an insert of a lathe), 10 mm thick, does not fit into the bore of 8 mm"
        ),
        "{thick}"
    );
}

#[test]
fn a_groove_deeper_than_its_tool_stands_over_the_shank_is_refused() {
    let groove = |x: f64| {
        let moves = [change(5), turn(800.0), to(24.0, -30.0), cut(x, -30.0), to(24.0, -30.0)];
        said_in(LengthUnit::Millimetre, "M0367", moves)
    };
    assert_eq!(groove(17.0), "");
    let deep = groove(14.0);
    assert!(
        deep.contains("the point of T5 (an insert of a lathe) stands 2 mm over its shank"),
        "{deep}"
    );
    assert!(deep.contains("the shank is 1 mm in the bar"), "{deep}");
}

//! The tool against the stock, before motion: what breaks it is refused, with what works, in the
//! program's words.
use crate::common;
use crate::common::{TOP, change, hole, line, machine, mm, program, rapid, tap, tools, turn};
use canon::{
    Axis, LengthUnit, OpKind, Position, ProgramFrame, Threading, Tool, ToolKind, ToolLibrary,
};
use plan::{Bodies, Planner, Start, Stock};
use units::{Angle, Lead, LeadGrowth, Length};

/// 100 mm square, 40 mm thick, its top at Z0 of G54.
const STOCK: Stock = Stock {
    from: [Length::mm(-50.0), Length::mm(-50.0), Length::mm(TOP - 40.0)],
    to: [Length::mm(50.0), Length::mm(50.0), Length::mm(TOP)],
    zero: Length::mm(TOP),
    bar: None,
};

/// A frame with a tool length offset in force.
fn g54(offset: f64) -> ProgramFrame {
    ProgramFrame {
        work_offset: 1,
        origin: Position::xyz(0.0, 0.0, TOP),
        tool: Position::xyz(0.0, 0.0, offset),
        ..ProgramFrame::default()
    }
}

fn all_tools() -> ToolLibrary {
    let mut tools = tools();
    let tool = |number, diameter, kind| Tool {
        number,
        pocket: number,
        length: mm(120.0),
        diameter: mm(diameter),
        kind,
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    };
    tools.insert(tool(8, 10.0, ToolKind::EndMill(canon::Mill::default())));
    // 18 mm out of a holder of 30 mm, flutes of 12 mm
    let body = canon::Body {
        flutes: Some(mm(12.0)),
        shank: None,
        stick_out: Some(mm(18.0)),
        holder: Some(mm(30.0)),
        ..canon::Body::default()
    };
    let point_angle = Angle::deg(118.0);
    tools.insert(Tool { body, ..tool(11, 5.0, ToolKind::Drill { point_angle }) });
    tools.insert(Tool { body, ..tool(12, 10.0, ToolKind::EndMill(canon::Mill::default())) });
    tools.insert(tool(9, 10.0, ToolKind::SpotDrill { point_angle: Angle::deg(90.0) }));
    let probe = canon::TouchProbe { pretravel: mm(0.012), lobing: mm(0.001) };
    tools.insert(tool(13, 6.0, ToolKind::Probe(probe)));
    let cutter =
        canon::PolygonCutter { radius: mm(50.0), inserts: vec![Angle::ZERO], nose_radius: mm(0.8) };
    tools.insert(tool(14, 100.0, ToolKind::PolygonCutter(cutter)));
    tools.insert(tool(15, 70.0, ToolKind::Other));
    tools.insert(tool(16, 40.0, ToolKind::Other));
    tools.insert(Tool {
        body: canon::Body::default(),
        stand_in: true,
        ..tool(10, 5.0, ToolKind::Other)
    });
    tools
}

/// Findings of a program whose Z is that of the tip over the stock's top, with a tool of
/// length 120.
fn said_in(frame: ProgramFrame, number: u32, kinds: impl IntoIterator<Item = OpKind>) -> String {
    let start = Start { position: Position::xyz(0.0, 0.0, -10.0), tool: 0 };
    let planner = Planner::new(machine(), all_tools(), common::OPTIONS, start);
    let mut planner = planner.with_stock(STOCK).only_judging();
    planner.written_in(frame);
    let ops = program([change(number), turn(3000.0)].into_iter().chain(kinds));
    for (index, op) in (0..).zip(&ops) {
        planner.push(index, op, &mut |_| ());
    }
    planner.finish(&mut |_| ());
    let found = planner.take_findings();
    let one = |d: &diag::Diagnostic| {
        let help = d.help.as_ref().map_or(String::new(), |h| format!(" | {h}"));
        format!("{} {:?} line {}: {}{help}\n", d.code, d.severity, d.span.line, d.message)
    };
    found.iter().map(one).collect()
}

fn said(number: u32, kinds: impl IntoIterator<Item = OpKind>) -> String {
    said_in(g54(120.0), number, kinds)
}

fn to(x: f64, z: f64) -> OpKind {
    rapid(x, 0.0, TOP + 120.0 + z)
}

fn fed(x: f64, z: f64) -> OpKind {
    line(x, 0.0, TOP + 120.0 + z, 300.0)
}

#[test]
fn a_rapid_into_the_stock_is_refused_with_the_height_that_works() {
    assert_eq!(
        said(1, [to(5.0, 10.0), to(5.0, -5.0)]),
        "M0360 Error line 4: the rapid takes T1 (a drill) 5 mm into the stock at X5 Y0 Z-5 of G54, whose top it touches \
         at Z0: Z2 or higher works, or a feed (G1)\n"
    );
    // across from beside the work
    assert!(
        said(1, [to(80.0, 10.0), to(80.0, -5.0), to(0.0, -5.0)]).starts_with("M0361 Error line 5")
    );
}

#[test]
fn a_rapid_into_what_is_drilled_already_is_none_into_the_stock() {
    assert_eq!(
        said(
            1,
            [
                to(5.0, 2.0),
                fed(5.0, -12.0),
                to(5.0, 2.0),
                to(5.0, -11.8),
                fed(5.0, -20.0),
                to(5.0, 9.0)
            ]
        ),
        ""
    );
    let deeper = said(1, [to(5.0, 2.0), fed(5.0, -12.0), to(5.0, 2.0), to(5.0, -14.0)]);
    assert!(
        deeper.contains(
            "takes T1 (a drill) 2 mm into the stock at X5 Y0 Z-14 of G54, deeper than what is open there: Z-12 is the deepest that works"
        ),
        "{deeper}"
    );
}

#[test]
fn a_tool_that_cuts_along_its_axis_may_not_mill() {
    for tool in [1, 9] {
        let text = said(tool, [to(0.0, 2.0), fed(0.0, -1.0), fed(20.0, -1.0), to(20.0, 2.0)]);
        assert!(
            text.starts_with("M0361 Error line 5") && text.contains("20 mm sideways, 1 mm deep"),
            "{text}"
        );
    }
    assert_eq!(
        said(8, [to(0.0, 2.0), fed(0.0, -1.0), fed(20.0, -1.0), to(20.0, 2.0)]),
        "",
        "an end mill may"
    );
    assert_eq!(
        said(1, [to(-80.0, -5.0), to(-80.0, 2.0)]),
        "",
        "beside the stock nothing is touched"
    );
}

#[test]
fn a_rapid_where_a_mill_has_passed_is_no_error_of_any_tool() {
    let pocket = [to(0.0, 2.0), fed(0.0, -5.0), fed(20.0, -5.0), to(20.0, 5.0)];
    let again = [to(0.0, 5.0), to(0.0, -4.9), to(20.0, -4.9), to(20.0, 5.0)];
    assert_eq!(said(8, pocket.clone().into_iter().chain(again)), "");
    let elsewhere = said(8, pocket.clone().into_iter().chain([to(40.0, 5.0), to(40.0, -4.0)]));
    assert!(elsewhere.starts_with("M0360 Warning line 8"), "{elsewhere}");
    let drilled = |x, y| {
        let at = |z| rapid(x, y, TOP + 120.0 + z);
        let down = [change(1), turn(3000.0), at(5.0), at(-4.0)];
        said(8, pocket.clone().into_iter().chain(down))
    };
    assert_eq!(drilled(10.0, 0.0), "", "it is open over all the drill's width");
    let half = drilled(10.0, 4.5);
    assert!(
        half.starts_with("M0360 Warning line 10") && half.contains("a mill has passed here"),
        "{half}"
    );
}

#[test]
fn a_drill_is_fed_only_while_it_turns_forwards_and_no_faster_than_it_bears() {
    let down = |feed| [to(5.0, 2.0), line(5.0, 0.0, TOP + 120.0 - 12.0, feed)];
    assert_eq!(said(1, down(300.0)), "");
    let still = said(1, [turn(0.0)].into_iter().chain(down(300.0)));
    assert!(still.contains("M0362 Error line 5") && still.contains("at rest: M3"), "{still}");
    let back = said(1, [turn(-3000.0)].into_iter().chain(down(300.0)));
    assert!(back.contains("M0362 Error") && back.contains("backwards (M4)"), "{back}");
    // 1 mm a turn: the core of 5 mm bears 5.3 N·m, which 0.43 mm a turn takes in C45
    let fast = said(1, down(3000.0));
    assert!(
        fast.starts_with("M0363 Error line 4")
            && fast.contains(", 0.43 per turn (F1290): F1161 works"),
        "{fast}"
    );
    // material and core scatter: from nine tenths on of what it bears it is said
    assert_eq!(said(1, down(1161.0)), "", "of what is advised nothing is said");
    for borne in [1200.0, 1290.0] {
        let nearly = said(1, down(borne));
        assert!(
            nearly.starts_with("M0363 Warning") && nearly.contains("nearly all that"),
            "{nearly}"
        );
        assert!(nearly.contains(", 0.43 per turn (F1290): F1161 works"), "{nearly}");
    }
    let more = said(1, down(1330.0));
    assert!(more.starts_with("M0363 Warning") && more.contains("more than"), "{more}");
}

#[test]
fn a_tap_goes_into_the_work_in_its_cycle_only() {
    let at = |z: f64| rapid(5.0, 0.0, TOP + 100.0 + z);
    let by_hand = said_in(g54(100.0), 2, [at(5.0), line(5.0, 0.0, TOP + 90.0, 3000.0)]);
    assert!(by_hand.starts_with("M0364 Error line 4"), "{by_hand}");
    let led = OpKind::Threading(Threading {
        to: Position::xyz(5.0, 0.0, TOP + 97.0),
        lead: Lead::mm_per_rev(1.0),
        growth: LeadGrowth::ZERO,
        start_angle: Angle::ZERO,
        axis: Axis::Z,
        surface: mm(TOP + 100.0),
    });
    let led = said_in(g54(100.0), 2, [at(5.0), turn(500.0), led]);
    assert!(led.starts_with("M0364 Error line 5") && led.contains("goes on turning"), "{led}");
    let cycle =
        said_in(g54(100.0), 2, [at(5.0), OpKind::Tap(tap(5.0, 0.0, 5.0, -10.0, 1.0, 3000.0))]);
    assert!(cycle.starts_with("M0324 Note") && cycle.lines().count() == 1, "{cycle}");
}

#[test]
fn a_length_offset_that_is_missing_or_anothers_is_named_once_with_what_it_does() {
    // no G43: the axis stands where a tool of no length would have its tip
    let forgotten = said_in(
        g54(0.0),
        1,
        [rapid(5.0, 0.0, TOP + 30.0), rapid(9.0, 0.0, TOP + 30.0), hole(9.0, 0.0, -140.0)],
    );
    assert!(forgotten.contains("M0360 Error line 3"), "{forgotten}");
    assert!(
        forgotten.contains("T1 is 120 mm long and no length offset is in force, so its tip is 120 mm below where the program has it: G43 H1 before this move works"),
        "{forgotten}"
    );
    assert_eq!(forgotten.matches("is 120 mm long").count(), 1, "{forgotten}");
    // another tool's H: 20 mm too high, and the tap is told of it in its cycle
    let mut high = tap(5.0, 0.0, 5.0, -30.0, 1.0, 3000.0);
    let by = mm(20.0);
    (high.start.linear[2], high.bottom, high.surface) =
        (high.start.linear[2] + by, high.bottom + by, high.surface + by);
    let up = rapid(5.0, 0.0, TOP + 125.0);
    let wrong = said_in(g54(120.0), 2, [up, OpKind::Tap(high)]);
    assert!(
        wrong.contains("M0365 Warning line 4: T2 is 100 mm long and H1 applies 120 mm, so its tip is 20 mm above where the program has it: G43 H2 works"),
        "{wrong}"
    );
}

#[test]
fn a_work_offset_that_carries_the_tools_length_needs_no_g43() {
    let frame = ProgramFrame { origin: Position::xyz(0.0, 0.0, TOP + 120.0), ..g54(0.0) };
    assert_eq!(said_in(frame, 1, [to(5.0, 2.0), fed(5.0, -10.0), to(5.0, 2.0)]), "");
}

#[test]
fn a_hole_or_thread_that_meets_no_stock_is_said_before_it_is_not_cut() {
    let above = said(1, [to(5.0, 30.0), hole(5.0, 0.0, 10.0)]);
    assert!(
        above.starts_with("M0366 Warning line 4: T1 (a drill) goes down to Z10 of G54"),
        "{above}"
    );
    let beside = said(1, [to(70.0, 30.0), hole(70.0, 0.0, -10.0)]);
    assert!(
        beside.contains("X70 Y0 lies beside the stock, which reaches from X-50 to X50 of G54"),
        "{beside}"
    );
}

#[test]
fn a_tap_of_which_only_the_chamfer_enters_cuts_no_full_thread() {
    let short = tap(5.0, 0.0, 5.0, -2.0, 1.0, 3000.0);
    let said = said_in(g54(100.0), 2, [rapid(5.0, 0.0, TOP + 105.0), OpKind::Tap(short)]);
    assert!(said.contains("M0368 Warning line 4: T2 (a tap) goes 2 mm deep into the stock, and its chamfer is 2.5 mm long"), "{said}");
}

#[test]
fn a_tip_deeper_than_the_flutes_is_refused_though_the_program_says_less() {
    // 10 mm too low by a length offset of 90: 25 mm programmed, 35 mm cut, flutes of 32 mm
    let low = tap(5.0, 0.0, 5.0, -35.0, 1.0, 3000.0);
    let low = canon::Tap { surface: mm(TOP + 90.0), ..low };
    let said = said_in(g54(90.0), 2, [rapid(5.0, 0.0, TOP + 105.0), OpKind::Tap(low)]);
    assert!(said.contains("M0367 Error line 4: T2 (a tap) goes 35 mm deep into the stock, and its flutes end 32 mm above its tip: Z-22 is the deepest that works"), "{said}");
}

#[test]
fn a_cut_with_no_tool_though_one_is_selected_is_said_once() {
    let select = |number| OpKind::SelectTool { number };
    let cuts = || [fed(5.0, -1.0), fed(9.0, -1.0)];
    let said_of = |kinds: Vec<OpKind>| said(0, kinds.into_iter().chain(cuts()));
    assert_eq!(
        said_of(vec![select(8), to(5.0, 5.0)]),
        "M0373 Warning line 5: this cuts with no tool: line 3 selects T8, and no M6 brings it into the spindle | write T8 M6 in place of T8\n"
    );
    // nothing is selected; the spindle stands; the tool comes; the one after it is selected ahead
    for honest in [
        vec![],
        vec![select(8), turn(0.0)],
        vec![select(8), change(8), turn(900.0)],
        vec![select(8), change(8), turn(900.0), select(9)],
        vec![select(8), select(0)],
    ] {
        let text = said_of(honest.clone());
        assert!(!text.contains("M0373"), "{honest:?}: {text}");
    }
    // of the second tool that is missing, too
    let twice = said_of(vec![select(8), fed(1.0, 5.0), select(9), fed(2.0, 5.0), select(9)]);
    assert_eq!(twice.matches("M0373").count(), 2, "{twice}");
}

#[test]
fn advice_comes_in_inches_where_the_program_is_in_inches() {
    let inches = ProgramFrame { unit: LengthUnit::Inch, ..g54(120.0) };
    let text = said_in(inches, 1, [to(5.0, 10.0), to(5.0, -2.54)]);
    assert!(
        text.contains("takes T1 (a drill) 0.1 in into the stock at X0.1969 Y0 Z-0.1 of G54"),
        "{text}"
    );
    assert!(text.contains(": Z0.1 or higher works"), "{text}");
    let fast = said_in(inches, 1, [to(5.0, 2.0), line(5.0, 0.0, TOP + 100.0, 3000.0)]);
    assert!(fast.contains("118.1102 in/min") && fast.contains("(F50.7): F45.6 works"), "{fast}");
}

#[test]
fn stand_ins_of_no_known_length_are_not_looked_at() {
    assert_eq!(said(10, [to(5.0, 10.0), to(5.0, -20.0), fed(40.0, -20.0)]), "");
}

#[test]
fn of_tools_that_are_assumed_nothing_is_refused() {
    let start = Start { position: Position::xyz(0.0, 0.0, -10.0), tool: 0 };
    let planner = Planner::new(machine(), all_tools(), common::OPTIONS, start);
    let mut planner = planner.with_stock(STOCK).with_assumed_tools();
    let ops = [change(1), turn(3000.0), to(5.0, 10.0), to(5.0, -30.0), fed(40.0, -30.0)];
    for (index, op) in (0..).zip(&program(ops)) {
        planner.push(index, op, &mut |_| ());
    }
    let found = planner.take_findings();
    assert!(!found.is_empty() && found.iter().all(|f| !f.is_error()), "{found:?}");
}

#[test]
fn many_moves_of_one_cause_are_one_finding_with_their_number_and_the_worst() {
    let moves =
        (1..=30).flat_map(|k| [to(f64::from(k), 5.0), to(f64::from(k), -f64::from(k % 7) - 1.0)]);
    let text = said(1, moves);
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(
        text.contains(
            "line 4: the rapid takes T1 (a drill) 7 mm into the stock at X6 Y0 Z-7 of G54"
        ) && text.contains(", in line 14, the worst of 30 such moves"),
        "{text}"
    );
}

#[test]
fn a_hole_that_breaks_through_a_side_of_the_stock_is_named() {
    // T1 is 5 mm thick, the block ends at X50
    let drilled = |x: f64| said(1, [to(x, 10.0), hole(x, 0.0, -10.0)]);
    let broken = drilled(49.0);
    assert!(broken.contains("M0366 Warning line 4"), "{broken}");
    assert!(broken.contains("breaks through a side of the stock: 1.5 mm of it are in the air"));
    assert_eq!(drilled(47.0), "");
}

#[test]
fn a_zero_that_is_not_the_workpieces_is_named_with_what_comes_of_it() {
    let shifted = |by: f64| {
        let OpKind::Hole(mut drilled) = hole(0.0, 0.0, -10.0) else { unreachable!() };
        drilled.zero += mm(by);
        said(1, [to(0.0, 10.0), OpKind::Hole(drilled)])
    };
    assert_eq!(shifted(0.0), "");
    assert!(shifted(3.0).contains("M0369 Warning line 4: the program's zero stands 3 mm above that of the workpiece: what is cut is 3 mm too shallow"), "{}", shifted(3.0));
    assert!(shifted(-5.0).contains("5 mm below"));
}

#[test]
fn a_drill_deeper_than_its_flutes_or_its_holder_is_refused_with_the_depth_that_works() {
    let text = said(11, [to(5.0, 2.0), hole(5.0, 0.0, -15.0)]);
    assert!(
        text.contains("M0367 Error line 4: T11 (a drill) goes 15 mm deep into the stock, and its flutes end 12 mm above its tip: Z-12 is the deepest that works"),
        "{text}"
    );
    let text = said(11, [to(5.0, 2.0), fed(5.0, -20.0)]);
    assert!(
        text.contains("its holder of 30 mm, which begins 18 mm above its tip, meets the stock: Z-18 is the deepest that works"),
        "{text}"
    );
    assert!(!said(11, [to(5.0, 2.0), fed(5.0, -11.5)]).contains("M0367"));
}

/// A pocket of 60 by 60 mm, 20 mm deep: the holder of 30 mm fits where its middle stays 15 mm off
/// the walls.
#[test]
fn a_holder_fits_into_a_pocket_that_is_wide_enough_and_not_into_a_slot() {
    let level = |depth: f64| {
        let rows = (-5..=5).flat_map(move |row| {
            let y = f64::from(row) * 5.0;
            let at = |x: f64| line(x, y, TOP + 120.0 - depth, 1000.0);
            [at(-25.0), at(25.0)]
        });
        rows.collect::<Vec<_>>()
    };
    let wide = [to(-25.0, 2.0)].into_iter().chain(level(10.0));
    let inside = [line(0.0, 0.0, TOP + 120.0 - 20.0, 500.0), line(8.0, 0.0, TOP + 100.0, 500.0)];
    let text = said(8, wide.clone().chain(inside.clone()));
    assert_eq!(text, "", "a tool of which nothing is stated is not judged");
    let text = said(12, wide.chain(inside));
    assert!(!text.contains("M0367"), "{text}");
    let slot = [to(-20.0, 2.0), fed(-20.0, -20.0), fed(20.0, -20.0)];
    let text = said(12, slot);
    assert!(text.contains("M0367 Error") && text.contains("its holder of 30 mm"), "{text}");
    // along a side of the stock the holder reaches over it, though the mill does not
    let side = [rapid(56.0, -40.0, TOP + 122.0), line(56.0, -40.0, TOP + 95.0, 500.0)];
    let side = said(12, side.into_iter().chain([line(56.0, 40.0, TOP + 95.0, 500.0)]));
    assert!(side.contains("M0367 Error"), "{side}");
}

#[test]
fn advice_to_incremental_blocks_is_incremental() {
    let g91 = ProgramFrame { counting: canon::Counting::Incremental, ..g54(120.0) };
    let text = said_in(g91, 1, [to(5.0, 10.0), to(5.0, -5.0)]);
    assert!(text.contains("into the stock at X5 Y0 Z-5 of G54"), "{text}");
    assert!(text.contains(": Z-8 (incremental) or higher works"), "{text}");
    let text = said_in(g91, 1, [to(5.0, 10.0), to(700.0, 10.0)]);
    assert!(text.contains("X245 (incremental) is the nearest that works"), "{text}");
}

/// The same with what the machine has beside it.
fn said_with(bodies: Bodies, number: u32, kinds: impl IntoIterator<Item = OpKind>) -> String {
    let start = Start { position: Position::xyz(0.0, 0.0, -10.0), tool: 0 };
    let planner = Planner::new(machine(), all_tools(), common::OPTIONS, start);
    let mut planner = planner.with_stock(STOCK).with_bodies(bodies).only_judging();
    planner.written_in(g54(if number == 0 { 0.0 } else { 120.0 }));
    let mount = (number != 0).then(|| change(number));
    for (index, op) in (0..).zip(&program(mount.into_iter().chain([turn(3000.0)]).chain(kinds))) {
        planner.push(index, op, &mut |_| ());
    }
    planner.finish(&mut |_| ());
    let found = planner.take_findings();
    let lines = found.iter().map(|d| format!("{} {:?}: {}\n", d.code, d.severity, d.message));
    lines.collect::<Vec<_>>().concat()
}

#[test]
fn whatever_is_in_the_spindle_is_not_taken_into_the_stock_by_a_rapid() {
    for number in [13, 14, 15, 16] {
        let down = said(number, [to(5.0, 10.0), to(5.0, -5.0)]);
        assert!(down.starts_with("M0360 Error line 4: the rapid takes T"), "T{number}: {down}");
        assert!(down.contains(" 5 mm into the stock at X5 Y0 Z-5 of G54"), "T{number}: {down}");
        // its rim, from beside
        let across = said(number, [to(110.0, 10.0), to(110.0, -5.0), to(48.0, -5.0)]);
        assert!(across.starts_with("M0360 Error line 5"), "T{number}: {across}");
        for clear in [
            vec![to(5.0, 10.0), to(5.0, 0.0), to(40.0, 0.1)],
            vec![to(110.0, 10.0), to(110.0, -5.0), to(150.0, -5.0)],
        ] {
            assert_eq!(said(number, clear), "", "T{number}");
        }
    }
}

#[test]
fn what_cuts_nothing_is_not_fed_into_the_stock_and_a_cutter_at_rest_neither() {
    let fed_in = |number| [to(5.0, 10.0), fed(5.0, -5.0)].map(|kind| (number, kind));
    let of = |moves: [(u32, OpKind); 2]| said(moves[0].0, moves.map(|(_, kind)| kind));
    let probe = of(fed_in(13));
    assert!(probe.starts_with("M0360 Error line 4: the feed takes T13"), "{probe}");
    assert!(probe.contains("or a probing move"), "{probe}");
    for number in [14, 15, 16] {
        assert_eq!(of(fed_in(number)), "", "T{number} cuts its way, and back out of it");
        let still = said(number, [turn(0.0), to(5.0, 10.0), fed(5.0, -5.0)]);
        assert!(still.contains("M0362 Error"), "T{number}: {still}");
        // where it was fed it goes by rapid
        let again = [to(5.0, 10.0), fed(5.0, -5.0), to(5.0, 10.0), to(5.0, -5.0)];
        assert_eq!(said(number, again), "", "T{number}");
    }
}

#[test]
fn behind_a_probing_move_a_probe_is_where_it_has_touched() {
    let order = canon::Probe {
        to: Position::xyz(5.0, 0.0, TOP + 120.0 - 10.0),
        feed: units::Speed::mm_per_min(100.0),
        until_contact: true,
        required: true,
    };
    assert!(!said(13, [to(5.0, 10.0), OpKind::Probe(order), to(5.0, -9.0)]).contains("M0360"));
    assert!(said(13, [to(5.0, 10.0), to(5.0, -9.0), OpKind::Probe(order)]).contains("M0360"));
}

#[test]
fn an_empty_spindle_has_a_nose() {
    let at = |x: f64, z: f64| rapid(x, 0.0, TOP + z);
    let cut = |x: f64, z: f64| line(x, 0.0, TOP + z, 300.0);
    let none = Bodies::default();
    let rapid = said_with(none, 0, [at(5.0, 10.0), at(5.0, -5.0)]);
    assert!(rapid.starts_with("M0360 Error: the rapid takes the nose of the spindle, in which no tool is, 5 mm into the stock"), "{rapid}");
    let contour =
        said_with(none, 0, [at(5.0, 10.0), cut(5.0, -5.0), cut(40.0, -5.0), at(40.0, 10.0)]);
    assert_eq!(contour.lines().count(), 1, "{contour}");
    assert!(contour.starts_with("M0373 Warning: this cuts with no tool: the program has called none, and the spindle's nose goes 5 mm"), "{contour}");
    assert_eq!(said_with(none, 0, [at(5.0, 10.0), cut(5.0, 0.0), cut(40.0, 0.0)]), "");
    // as wide as the machine's file says
    let wide = Bodies { nose: Some(mm(80.0)), ..none };
    let beside = [at(80.0, 10.0), at(80.0, -5.0)];
    assert_eq!(said_with(none, 0, beside.clone()), "");
    assert!(said_with(wide, 0, beside).starts_with("M0360 Error"));
    // tools that are clamped by hand are not named
    let by_hand = Bodies { tools_by_hand: true, ..none };
    assert_eq!(said_with(by_hand, 0, [at(5.0, 10.0), at(5.0, -5.0)]), "");
}

#[test]
fn the_nose_behind_a_short_tool_meets_the_stock() {
    let wide = Bodies { nose: Some(mm(80.0)), ..Bodies::default() };
    let deep = [to(60.0, 10.0), to(60.0, -30.0)];
    assert_eq!(said_with(wide, 8, deep), "", "120 mm long, 30 mm deep beside the stock");
    let deeper = said_with(wide, 8, [to(60.0, 10.0), to(60.0, -125.0)]);
    assert!(
        deeper.contains("M0367 Error") && deeper.contains("the spindle's nose of 80 mm"),
        "{deeper}"
    );
}

#[test]
fn a_wheel_keeps_off_its_work_by_rapid() {
    let wheel = Bodies { wheel: Some(mm(150.0)), ..Bodies::default() };
    let at = |x: f64| rapid(x, 0.0, TOP + 100.0);
    assert_eq!(said_with(wheel, 0, [at(240.0), at(205.0)]), "");
    let into = said_with(wheel, 0, [at(240.0), at(190.0)]);
    assert!(
        into.starts_with(
            "M0360 Error: the rapid takes the grinding wheel 10 mm into the stock at X190"
        ),
        "{into}"
    );
    assert!(into.contains(": X202 is clear of it"), "{into}");
}

#[test]
fn a_hole_that_the_work_has_is_open_to_a_probe() {
    let start = Start { position: Position::xyz(0.0, 0.0, -10.0), tool: 0 };
    let found = |holes: &[([f64; 2], [f64; 2])]| {
        let planner = Planner::new(machine(), all_tools(), common::OPTIONS, start);
        let mut planner = planner.with_stock(STOCK).with_holes(holes.iter().copied());
        planner.written_in(g54(120.0));
        for (index, op) in (0..).zip(&program([change(13), to(6.0, 10.0), to(6.0, -8.0)])) {
            planner.push(index, op, &mut |_| ());
        }
        planner.take_findings().len()
    };
    assert_eq!((found(&[]), found(&[([5.0, 0.0], [30.0, 20.0])])), (1, 0));
    assert_eq!(found(&[([5.0, 0.0], [30.0, 5.0])]), 1, "not so deep");
}

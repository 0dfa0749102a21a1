//! What holds the work of a lathe, before motion: no tool goes into chuck and tailstock, whichever
//! of the turret's tools it is.
use crate::common;
use crate::common::{change, line, machine, mm, program, rapid, tool, turn};
use canon::{Insert, OpKind, Position, ProgramFrame, Tool, ToolKind, ToolLibrary};
use plan::{Bar, Bodies, Cylinder, Planner, Start, Stock, Turret};
use units::{Angle, Length};

/// A bar of 40 mm that stands 100 mm out of its chuck; its face is Z0 of G54, Z-200 of the machine.
const FACE: f64 = -200.0;
const STOCK: Stock = Stock {
    from: [Length::mm(-20.0), Length::mm(-20.0), Length::mm(FACE - 100.0)],
    to: [Length::mm(20.0), Length::mm(20.0), Length::mm(FACE)],
    zero: Length::mm(FACE),
    bar: Some(Bar { radius: Length::mm(20.0), bore: Length::ZERO }),
};
/// A chuck of 160 mm whose jaws end 60 mm behind the bar's face; a tailstock of 50 mm before it.
const CHUCK: Cylinder = Cylinder {
    radius: Length::mm(80.0),
    from: Length::mm(FACE - 500.0),
    to: Length::mm(FACE - 60.0),
};
const TAILSTOCK: Cylinder = Cylinder {
    radius: Length::mm(25.0),
    from: Length::mm(FACE + 5.0),
    to: Length::mm(FACE + 500.0),
};
/// Twelve stations: the next one stands 13.4 mm farther out and 50 mm aside.
const TURRET: Turret = Turret { stations: 12, radius: Length::mm(100.0) };

fn tools(drill_station: u32) -> ToolLibrary {
    let mut tools = ToolLibrary::default();
    let insert = Insert::turning(Angle::deg(80.0), mm(0.4));
    tools.insert(tool(1, 0.0, 20.0, ToolKind::Insert(insert)));
    let drill = ToolKind::Drill { point_angle: Angle::deg(118.0) };
    tools.insert(Tool { pocket: drill_station, ..tool(2, 16.0, 120.0, drill) });
    tools
}

fn said(bodies: Bodies, drill_station: u32, kinds: impl IntoIterator<Item = OpKind>) -> String {
    let start = Start { position: Position::xyz(150.0, 0.0, -10.0), tool: 0 };
    let planner = Planner::new(machine(), tools(drill_station), common::OPTIONS, start);
    let planner = planner.turning_work().with_stock(STOCK).with_bodies(bodies);
    let mut planner = planner.only_judging();
    planner.written_in(ProgramFrame {
        work_offset: 1,
        origin: Position::xyz(0.0, 0.0, FACE),
        tool: Position::xyz(0.0, 0.0, 20.0),
        x_is_diameter: true,
        ..ProgramFrame::default()
    });
    let kinds = [change(1), turn(800.0)].into_iter().chain(kinds);
    for (index, op) in (0..).zip(&program(kinds)) {
        planner.push(index, op, &mut |_| ());
    }
    planner.finish(&mut |_| ());
    let found = planner.take_findings();
    found.iter().filter(|d| d.code == "M0360").fold(String::new(), |all, d| {
        format!("{all}{:?} line {}: {}\n", d.severity, d.span.line, d.message)
    })
}

/// A rapid to a diameter and a Z of the program; the same as a cut.
fn to(x: f64, z: f64) -> OpKind {
    rapid(x / 2.0, 0.0, FACE + 20.0 + z)
}

fn cut(x: f64, z: f64) -> OpKind {
    line(x / 2.0, 0.0, FACE + 20.0 + z, 100.0)
}

fn with(chuck: bool, tailstock: bool, turret: bool) -> Bodies {
    Bodies {
        chuck: chuck.then_some(CHUCK),
        tailstock: tailstock.then_some(TAILSTOCK),
        turret: turret.then_some(TURRET),
        ..Bodies::default()
    }
}

#[test]
fn no_tool_goes_into_the_chuck_by_rapid_or_feed() {
    let chuck = with(true, false, false);
    let turned = [to(60.0, 2.0), to(36.0, 2.0), cut(36.0, -58.0), cut(44.0, -58.0)];
    assert_eq!(said(chuck, 9, turned.clone()), "", "2 mm before the jaws");
    let fed = said(chuck, 9, [to(60.0, 2.0), to(36.0, 2.0), cut(36.0, -65.0)]);
    assert!(fed.starts_with("Error line 5: the feed takes T1"), "{fed}");
    assert!(fed.contains("5 mm into the chuck") && fed.contains("Z-58 or more is clear"), "{fed}");
    let beside = said(chuck, 9, [to(100.0, 2.0), to(100.0, -70.0)]);
    assert!(beside.starts_with("Error line 4: the rapid takes T1"), "{beside}");
    assert_eq!(said(chuck, 9, [to(180.0, 2.0), to(180.0, -70.0)]), "", "beside the chuck");
    assert_eq!(said(with(false, false, false), 9, [to(180.0, 2.0), to(100.0, -70.0)]), "");
}

#[test]
fn no_tool_goes_into_the_tailstock_by_rapid_or_feed() {
    let centre = with(false, true, false);
    let faced = said(centre, 9, [to(60.0, 20.0), to(30.0, 20.0)]);
    assert!(faced.starts_with("Error line 4: the rapid takes T1"), "{faced}");
    assert!(faced.contains("10 mm into the tailstock") && faced.contains("or less"), "{faced}");
    assert_eq!(said(centre, 9, [to(60.0, 20.0), to(52.0, 20.0), to(52.0, 2.0)]), "");
    assert_eq!(
        said(centre, 9, [to(60.0, 20.0), to(60.0, 2.0), to(36.0, 2.0), cut(36.0, -20.0)]),
        ""
    );
}

#[test]
fn a_long_tool_beside_the_one_that_cuts_does_not_go_into_the_chuck() {
    // the drill's tip stands 100 mm before the insert's: the jaws are reached 40 mm behind the face
    let roughing = |z| [to(60.0, 45.0), to(36.0, 45.0), cut(36.0, z)];
    let all = with(true, false, true);
    assert_eq!(said(all, 2, roughing(42.0)), "");
    let met = said(all, 2, roughing(30.0));
    assert!(met.starts_with("Error line 5: the feed of T1"), "{met}");
    assert!(
        met.contains("T2 (a drill), in station 2 of the turret, 10 mm into the chuck at X36"),
        "{met}"
    );
    assert!(met.contains(": Z42 or more is clear of it, or a station farther away"), "{met}");
    // to the other side too, not opposite, and not without a turret in the machine's file
    assert!(said(all, 12, roughing(30.0)).contains("station 12"));
    assert_eq!(said(all, 7, roughing(30.0)), "");
    assert_eq!(said(with(true, false, false), 2, roughing(30.0)), "");
    // farther out than the chuck is wide
    assert_eq!(said(all, 2, [to(200.0, 45.0), to(200.0, 20.0)]), "");
    let rapid = said(all, 2, [to(60.0, 45.0), to(60.0, 20.0)]);
    assert!(rapid.starts_with("Error line 4: the rapid of T1"), "{rapid}");
}

#[test]
fn a_tool_beside_the_one_that_cuts_does_not_go_into_the_tailstock_or_a_thick_bar() {
    // of a turret of many stations the next one stands near: 10.5 mm aside, 0.5 mm farther out
    let near = Turret { stations: 60, ..TURRET };
    let centre = Bodies { turret: Some(near), ..with(false, true, false) };
    let faced = [to(120.0, 20.0), to(54.0, 20.0)];
    let met = said(centre, 2, faced.clone());
    assert!(met.starts_with("Error line 4: the rapid of T1"), "{met}");
    assert!(met.contains("into the tailstock at X54") && met.contains(": X"), "{met}");
    assert_eq!(said(centre, 20, faced), "", "far from it");
    assert_eq!(said(centre, 2, [to(120.0, 20.0), to(75.0, 20.0)]), "");
    let bar = Bodies { turret: Some(near), ..Bodies::default() };
    let shallow = [to(60.0, 104.0), to(38.0, 104.0), to(38.0, 90.0)];
    let met = said(bar, 2, shallow.clone());
    assert!(met.contains("5.833 mm into the bar at X38"), "{met}");
    assert_eq!(said(bar, 20, shallow), "");
    assert_eq!(said(bar, 2, [to(60.0, 104.0), to(38.0, 104.0)]), "");
}

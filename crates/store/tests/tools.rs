//! Tool tables: both notations give the same library, and a bad one is refused with all its
//! mistakes.

use canon::{Flute, Holder, Mill, MillForm, Tool, ToolKind};
use diag::Diagnostic;
use proptest::prelude::*;
use store::tools::{self, TableUnit, ToolTable};
use units::{Angle, Lead, Length, Stiffness};

const SHOP: &str = r#"
[[tool]]
number = 1
kind = "spot-drill"
diameter_mm = 10.0
length_mm = 92.0

[[tool]]
number = 2
pocket = 7
kind = "drill"
description = "drill 5.0"
diameter_mm = 5.0
point_angle_deg = 140.0
length_mm = 118.5

[[tool]]
number = 3
kind = "tap"
description = "M6 spiral flute"
length_mm = 105.25
thread = "M6"
chamfer_pitches = 2.5
thread_length_mm = 25.0
flute = "spiral-flute"
oversize_um = 40.0
holder = { kind = "rigid", stiffness_n_per_um = 20.0 }

[[tool]]
number = 12
kind = "tap"
length_mm = 140.0
thread = "M8x1.25-LH"
chamfer_pitches = 4.5
thread_length_mm = 28.0
flute = "spiral-point"
holder = { kind = "tension-compression", stiffness_n_per_mm = 25.0, travel_mm = 8.0 }

[[tool]]
number = 4
kind = "end-mill"
diameter_mm = 16
length_mm = 110
"#;

fn sentences(findings: &[Diagnostic], text: &str) -> String {
    let line = |d: &Diagnostic| {
        let place = text.get(d.span.start as usize..d.span.end as usize).unwrap();
        let first = d.labels.first().map_or(String::new(), |l| format!(" (line {})", l.span.line));
        format!("{} {} {}{first} [{place}]", d.span.line, d.code, d.message)
    };
    findings.iter().map(line).collect::<Vec<_>>().join("\n")
}

fn refused_toml(text: &str) -> String {
    sentences(&tools::parse_toml(text, 0).unwrap_err(), text)
}

fn tbl(text: &str) -> ToolTable {
    tools::parse_tbl(text, 0, TableUnit::Millimetre).unwrap()
}

fn refused_tbl(text: &str) -> String {
    sentences(&tools::parse_tbl(text, 0, TableUnit::Millimetre).unwrap_err(), text)
}

fn flat() -> ToolKind {
    ToolKind::EndMill(Mill { form: Some(MillForm::FLAT), ..Mill::default() })
}

fn tool(table: &ToolTable, number: u32) -> &Tool {
    table.library.get(number).unwrap()
}

#[test]
fn a_toml_table_says_what_each_tool_is() {
    let table = tools::parse_toml(SHOP, 0).unwrap();
    assert_eq!(table.library.iter().map(|t| t.number).collect::<Vec<_>>(), [1, 2, 3, 4, 12]);
    assert_eq!(tool(&table, 1).kind, ToolKind::SpotDrill { point_angle: Angle::deg(90.0) });
    assert_eq!((tool(&table, 1).pocket, tool(&table, 2).pocket), (1, 7));
    assert_eq!(tool(&table, 2).kind, ToolKind::Drill { point_angle: Angle::deg(140.0) });
    assert_eq!(tool(&table, 2).length, Length::mm(118.5));
    assert_eq!(tool(&table, 4).kind, flat());
}

#[test]
fn a_tap_has_its_threads_lead_and_diameter_and_its_holders_spring() {
    let table = tools::parse_toml(SHOP, 0).unwrap();
    let ToolKind::Tap(m6) = &tool(&table, 3).kind else { panic!("a tap") };
    assert_eq!((m6.designation.as_str(), m6.lead), ("M6x1", Lead::mm_per_rev(1.0)));
    assert_eq!(tool(&table, 3).diameter, Length::mm(6.0));
    assert_eq!((m6.flute, m6.oversize), (Flute::SpiralFlute, Length::um(40.0)));
    assert_eq!(m6.holder, Holder::Rigid { stiffness: Stiffness::n_per_mm(20_000.0) });
    let ToolKind::Tap(left) = &tool(&table, 12).kind else { panic!("a tap") };
    assert_eq!((left.designation.as_str(), left.lead), ("M8x1.25", Lead::mm_per_rev(-1.25)));
    let spring = Holder::TensionCompression {
        stiffness: Stiffness::n_per_mm(25.0),
        travel: Length::mm(8.0),
    };
    assert_eq!(left.holder, spring);
}

#[test]
fn all_mistakes_of_a_toml_table_are_told_at_once() {
    let text = SHOP
        .replace("number = 12", "number = 3")
        .replace("diameter_mm = 16", "diameter_mm = nan\ncolour = \"red\"")
        .replace("thread = \"M6\"", "thread = \"N6\"")
        .replace("travel_mm = 8.0", "travle_mm = 8.0")
        .replace("kind = \"spot-drill\"", "kind = \"spot\"")
        .replace("point_angle_deg = 140.0", "point_angle_deg = 0");
    insta::assert_snapshot!(refused_toml(&text));
}

#[test]
fn a_tool_that_comes_twice_is_refused_with_both_places() {
    insta::assert_snapshot!(refused_toml(&SHOP.replace("number = 12", "number = 3")));
}

#[test]
fn a_taps_diameter_must_be_its_threads() {
    let text = SHOP.replace("thread = \"M6\"", "thread = \"M6\"\ndiameter_mm = 8");
    insta::assert_snapshot!(refused_toml(&text));
}

#[test]
fn a_linuxcnc_table_is_read_in_either_order_of_words() {
    let table =
        tbl("T1 P1 D0.125 Z+0.511 ;1/8 end mill\nT3 P5 Z3.3 D5 ;5mm tap drill\r\nT7 P7 Z7.7 D2.5");
    assert_eq!(tool(&table, 1).length, Length::mm(0.511));
    assert_eq!(tool(&table, 1).kind, flat());
    assert_eq!((tool(&table, 3).pocket, tool(&table, 3).diameter), (5, Length::mm(5.0)));
    assert_eq!(tool(&table, 3).description, "5mm tap drill");
    assert_eq!(tool(&table, 7).kind, ToolKind::Other);
    // the first row is one of inches, and the table was read in millimetres
    assert_eq!(
        table.remarks.iter().map(|r| (r.code, r.span.line)).collect::<Vec<_>>(),
        [("S0508", 1)]
    );
    assert_eq!((table.remarks_of(1).count(), table.remarks_of(3).count()), (1, 0));
}

#[test]
fn an_inch_table_is_converted() {
    let table = tools::parse_tbl("T1 Z1 D.25", 0, TableUnit::Inch).unwrap();
    assert_eq!(
        (tool(&table, 1).length, tool(&table, 1).diameter),
        (Length::mm(25.4), Length::mm(6.35))
    );
}

#[test]
fn a_toml_table_may_state_lengths_in_inches() {
    let text = "[[tool]]\nnumber = 1\nkind = \"end-mill\"\nlength_in = 2\ndiameter_in = 0.25\n";
    let table = tools::parse_toml(text, 0).unwrap();
    let (length, diameter) = (tool(&table, 1).length, tool(&table, 1).diameter);
    assert_eq!((length, diameter), (Length::mm(50.8), Length::mm(6.35)));
    let twice = text.replace("length_in = 2", "length_in = 2\nlength_mm = 50.8");
    assert!(refused_toml(&twice).contains("`length_mm` states it too"), "{}", refused_toml(&twice));
}

#[test]
fn words_without_effect_and_taps_without_a_thread_are_remarked() {
    let text =
        "T1 P1 X0.5 Z1 I95 Q1 ;turning\nT2 P2 Z1 Y0 ;tap\nT0 P0 ;no tool\n\n; only a comment\n";
    let table = tbl(text);
    assert_eq!(table.library.iter().count(), 2);
    insta::assert_snapshot!(sentences(&table.remarks, text));
}

#[test]
fn all_mistakes_of_a_linuxcnc_table_are_told_at_once() {
    insta::assert_snapshot!(refused_tbl(
        "T1 P1 Znan\nP2 Z1\nT3 Z1 Z2\nT4 D-5\nT5.5\nT6 Z1e9\nT7 Z99999\nT8\nT8 G5\nT8 P1\nä5\n"
    ));
}

#[test]
fn the_table_of_linuxcnc_before_2_4_is_named() {
    insta::assert_snapshot!(refused_tbl("TOOLNO POCKET LENGTH\n1 1 0.5\n"));
}

#[test]
fn the_shipped_tables_describe_the_same_tools() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../programs");
    let toml = tools::load(&folder.join("tools.toml"), tools::TableUnit::Millimetre).unwrap();
    let tbl = tools::load(&folder.join("tools.tbl"), tools::TableUnit::Millimetre).unwrap();
    assert!(tbl.remarks.is_empty(), "{:?}", tbl.remarks);
    assert_eq!(toml.library.iter().count(), tbl.library.iter().count());
    for (a, b) in toml.library.iter().zip(tbl.library.iter()) {
        assert_eq!(
            (a.number, a.pocket, a.length, a.diameter),
            (b.number, b.pocket, b.length, b.diameter)
        );
        match (&a.kind, &b.kind) {
            (ToolKind::Tap(a), ToolKind::Tap(b)) => {
                assert_eq!((&a.designation, a.lead), (&b.designation, b.lead));
            }
            (ToolKind::PolygonCutter(a), ToolKind::PolygonCutter(b)) => assert_eq!(a, b),
            (ToolKind::Insert(a), ToolKind::Insert(b)) => assert_eq!(a, b),
            (ToolKind::Hob(a), ToolKind::Hob(b)) => {
                assert_eq!(*a, canon::HobTool { length: a.length, ..*b });
            }
            (a, b) => assert_eq!(std::mem::discriminant(a), std::mem::discriminant(b)),
        }
    }
}

#[test]
fn an_insert_has_an_angle_and_a_point_that_may_be_left_to_the_standard() {
    let insert = |keys: &str| {
        let text = format!(
            "[[tool]]\nnumber = 1\nkind = \"threading-insert\"\nlength_mm = 60.0\n{keys}\n"
        );
        tools::parse_toml(&text, 0).map(|table| match tool(&table, 1).kind {
            ToolKind::Insert(insert) => insert,
            ref other => panic!("{other:?}"),
        })
    };
    let bare = insert("").unwrap();
    assert!((bare.angle.in_deg() - 60.0).abs() < 1e-9 && bare.point.is_none());
    let stated = insert("flank_angle_deg = 55\nflat_mm = 0.2\ncrest_height_mm = 0.9").unwrap();
    assert_eq!(stated.point, Some(canon::InsertPoint::Flat(Length::mm(0.2))));
    assert_eq!(stated.crest_height, Some(Length::mm(0.9)));
    let twice = insert("flat_mm = 0.2\nnose_radius_mm = 0.1").unwrap_err();
    assert!(twice[0].message.contains("stated twice"), "{twice:?}");
}

#[test]
fn the_notation_is_told_by_the_files_end() {
    let dir = tempfile::tempdir().unwrap();
    let (a, b) = (dir.path().join("a.tbl"), dir.path().join("b.toml"));
    std::fs::write(&a, "T1 P1 Z92 D10 ;spot drill").unwrap();
    std::fs::write(&b, SHOP).unwrap();
    let by_tbl = tools::load(&a, tools::TableUnit::Millimetre).unwrap();
    let by_toml = tools::load(&b, tools::TableUnit::Millimetre).unwrap();
    assert_eq!(tool(&by_tbl, 1).kind, tool(&by_toml, 1).kind);
}

proptest! {
    #[test]
    fn no_bytes_make_a_reader_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let text = String::from_utf8_lossy(&bytes);
        let _ = tools::parse_toml(&text, 0);
        let _ = tools::parse_tbl(&text, 0, TableUnit::Millimetre);
    }

    #[test]
    fn nearly_good_lines_make_no_reader_panic(text in "([TPDXZ;]?[-+0-9.Mx/# ]{0,8}( tap| drill|-LH| UNC)?\n?){0,12}") {
        let _ = tools::parse_tbl(&text, 0, TableUnit::Millimetre);
    }
}

#[test]
fn a_clutch_holder_has_splines_a_pawl_and_a_spring() {
    let holder = "{ kind = \"clutch\", stiffness_n_per_mm = 10.0, spline_length_mm = 5.0, pawl_backlash_rev = 0.1, compression_mm = 3.0 }";
    let text = SHOP.replace("{ kind = \"rigid\", stiffness_n_per_um = 20.0 }", holder);
    let table = tools::parse_toml(&text, 0).unwrap();
    let ToolKind::Tap(tap) = &table.library.get(3).unwrap().kind else { panic!("T3 is a tap") };
    let clutch = Holder::Clutch {
        spline_length: Length::mm(5.0),
        pawl_backlash: Angle::rev(0.1),
        stiffness: Stiffness::n_per_mm(10.0),
        compression: Length::mm(3.0),
    };
    assert_eq!(tap.holder, clutch);
    let without = SHOP.replace("{ kind = \"rigid\",", "{ kind = \"clutch\",");
    let found = tools::parse_toml(&without, 0).unwrap_err();
    assert!(found[0].message.contains("spline_length_mm"), "{found:?}");
}

#[test]
fn a_hob_has_a_module_or_a_diametral_pitch_and_else_the_rack_of_iso_53() {
    let hob = |keys: &str| {
        let text = format!(
            "[[tool]]\nnumber = 1\nkind = \"hob\"\nlength_mm = 60.0\ndiameter_mm = 70.0\n{keys}\n"
        );
        tools::parse_toml(&text, 0).map(|table| match tool(&table, 1).kind {
            ToolKind::Hob(hob) => hob,
            ref other => panic!("{other:?}"),
        })
    };
    let usual = hob("module_mm = 2").unwrap();
    assert_eq!((usual.addendum, usual.tip_radius), (Length::mm(2.5), Length::mm(0.76)));
    assert_eq!((usual.signed_starts(), usual.cuts_backwards), (1, false));
    let inch =
        hob("diametral_pitch = 10\nstarts = 2\nhand = \"left\"\ncuts_with = \"M4\"").unwrap();
    assert!((inch.module.value() - 2.54).abs() < 1e-12);
    assert_eq!((inch.signed_starts(), inch.cuts_backwards), (-2, true));
    for wrong in ["", "module_mm = 2\ndiametral_pitch = 12.7", "module_mm = 2\nstarts = 0"] {
        assert!(hob(wrong).is_err(), "{wrong}");
    }
}

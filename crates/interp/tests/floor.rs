//! What programs of the shop floor write, and what must not be read as something else without a word.
#![allow(clippy::unwrap_used)] // a test may panic
use canon::{Hole, OpKind};
use interp::{Dialect, MissingTools, Ops, Setup};

fn setup(dialect: Dialect) -> Setup {
    Setup { dialect, missing_tools: MissingTools::StandIn, ..Setup::default() }
}

fn ops(text: &str, dialect: Dialect) -> Vec<OpKind> {
    let setup = setup(dialect);
    let mut ops = Ops::new(text.as_bytes(), &setup);
    let kinds = ops.by_ref().map(|op| op.kind).collect();
    let found: Vec<_> = ops.diagnostics().into_iter().filter(diag::Diagnostic::is_error).collect();
    assert!(found.is_empty(), "{text}: {found:?}");
    kinds
}

fn places(kinds: &[OpKind]) -> Vec<[f64; 3]> {
    let ends = kinds.iter().filter_map(|kind| match kind {
        OpKind::Rapid { to } | OpKind::Line { to, .. } | OpKind::Arc { to, .. } => Some(to),
        _ => None,
    });
    ends.map(|to| to.linear.map(units::Length::value)).collect()
}

fn holes(text: &str, dialect: Dialect) -> Vec<Hole> {
    let kinds = ops(text, dialect).into_iter();
    kinds.filter_map(|kind| if let OpKind::Hole(hole) = kind { Some(hole) } else { None }).collect()
}

#[test]
fn blank_lines_and_comments_before_the_percent_sign_are_no_program() {
    for head in ["", "\n", "\r\n \r\n", "(made by a post)\n", "; made by a post\n\n(today)\n"] {
        for dialect in Dialect::ALL {
            let is_fanuc = dialect.name().starts_with("fanuc");
            if is_fanuc && head.starts_with(';') {
                continue; // there it ends a block
            }
            let number = if is_fanuc { "O1\n" } else { "" };
            let text = format!("{head}%\n{number}G21 G90\nG0 X10.\nM30\n%\nwhatever follows\n");
            let found = places(&ops(&text, dialect));
            assert!(!found.is_empty(), "{head:?} in {} is empty", dialect.name());
        }
    }
}

#[test]
fn a_percent_sign_behind_blocks_ends_the_program_and_its_subprograms() {
    let kinds = ops("G21 G90\nG0 X10\n%\nG0 X20\nM2\n", Dialect::LinuxCnc);
    assert_eq!(places(&kinds).len(), 1);
    let setup = setup(Dialect::LinuxCnc);
    let text = "%\nG21 G90\no100 call\n%\no100 sub\nG0 X1\no100 endsub\nM2\n";
    let mut ops = Ops::new(text.as_bytes(), &setup);
    assert_eq!(places(&ops.by_ref().map(|op| op.kind).collect::<Vec<_>>()), [[0.0; 3]; 0]);
    assert!(ops.diagnostics().iter().any(diag::Diagnostic::is_error), "o100 is not there");
}

#[test]
fn comments_stand_between_the_arguments_of_a_call() {
    let text = "o100 sub\nG0 X#1 Y#2\no100 endsub\nG21 G90\no100 call (x) [1] (y) [2] (done)\nM2\n";
    assert_eq!(places(&ops(text, Dialect::LinuxCnc)), [[1.0, 2.0, 0.0]]);
}

/// Fanuc: of the block that sets an offset, its own G90 or G91 counts, and not the one of a block before.
#[test]
fn an_offset_is_set_or_added_to_as_its_own_block_says() {
    let z = |offsets: &str| {
        let text = format!("O1\nG21 G90\n{offsets}\nG90 G0 G43 H1 Z0.\nM30\n");
        places(&ops(&text, Dialect::Fanuc)).last().unwrap()[2]
    };
    assert!((z("G10 L10 P1 R100.\nG91 G10 L10 P1 R-0.1") - 99.9).abs() < 1e-9);
    assert!((z("G91\nG90 G10 L10 P1 R100.\nG90 G10 L10 P1 R50.") - 50.0).abs() < 1e-9);
    let x = |offsets: &str| {
        let text = format!("O1\nG21 G90 G54\n{offsets}\nG90 G0 X1.\nM30\n");
        places(&ops(&text, Dialect::Fanuc)).last().unwrap()[0]
    };
    assert!((x("G10 L2 P1 X10.\nG91 G10 L2 P1 X5.") - 16.0).abs() < 1e-9);
    assert!((x("G91 G10 L2 P1 X10.\nG90 G10 L2 P1 X5.") - 6.0).abs() < 1e-9);
}

/// Fanuc: R and Z that a cycle keeps lie where they were meant, though G90 or G91 comes between.
#[test]
fn a_cycle_keeps_its_levels_when_it_goes_on_in_increments() {
    let levels = |cycle: &str| -> Vec<[f64; 3]> {
        let text = format!("O1\nG21 G90 G94 F100 S500 M3\nG0 X0 Y0 Z50.\n{cycle}\nG80\nM30\n");
        let holes = holes(&text, Dialect::Fanuc).into_iter();
        holes
            .map(|hole| {
                [hole.at.linear[0], hole.at.linear[2], hole.bottom].map(units::Length::value)
            })
            .collect()
    };
    let row: Vec<_> = (0..4).map(|i| [10.0 * f64::from(i), 2.0, -10.0]).collect();
    assert_eq!(levels("G99 G81 X0 Y0 Z-10. R2.\nG91 X10. K3"), row);
    assert_eq!(levels("G91 G99 G81 X0 Y0 Z-12. R-48.\nG90 X10.\nX20.\nX30."), row);
    // a word that is written anew means what is in force with it
    let deeper = levels("G99 G81 X0 Y0 Z-10. R2.\nG91 X10. Z-15.");
    assert_eq!(deeper, [[0.0, 2.0, -10.0], [10.0, 2.0, -13.0]]);
}

#[test]
fn holes_on_a_circle_stay_on_it_however_many_one_block_makes() {
    let text = "O1\nG21 G90 G94 F100 S500 M3\nG0 X0 Y0 Z50.\nG16\nG99 G81 X20. Y0 Z-10. R2.\nG91 Y60. K5\nG15 G80\nM30\n";
    let holes = holes(text, Dialect::Fanuc);
    assert_eq!(holes.len(), 6);
    for (i, hole) in (0..).zip(&holes) {
        let angle = (60.0 * f64::from(i)).to_radians();
        let [x, y, z] = hole.at.linear.map(units::Length::value);
        assert!(
            (x - 20.0 * angle.cos()).abs() < 1e-9 && (y - 20.0 * angle.sin()).abs() < 1e-9,
            "{i}: {x} {y}"
        );
        assert!((z - 2.0).abs() < 1e-9, "{z}");
    }
}

/// Without a radius the tool is led on the programmed way: no corner is rounded, none is too narrow.
#[test]
fn a_cutter_of_no_radius_is_led_on_the_programmed_way() {
    let corners = "X20\nY20\nX40\nY10\nG2 X60 Y10 I10 J0\nG1 X60 Y-20\nX0";
    let plain =
        ops(&format!("G21 G90 F100\nG0 X0 Y0\nG1 X10 Y0\n{corners}\nM2\n"), Dialect::LinuxCnc);
    for side in ["G41.1 D0", "G42.1 D0"] {
        let text = format!("G21 G90 F100\nG0 X0 Y0\n{side}\nG1 X10 Y0\n{corners}\nG40\nM2\n");
        assert_eq!(places(&ops(&text, Dialect::LinuxCnc)), places(&plain), "{side}");
    }
}

/// Fanuc: in brackets a number is an expression, and counts whole units; alone, without a point, it counts increments.
#[test]
fn a_number_in_brackets_counts_whole_units() {
    let x =
        |word: &str| places(&ops(&format!("O1\nG21 G90\nG0 {word}\nM30\n"), Dialect::Fanuc))[0][0];
    for (word, wanted) in [
        ("X[1]", 1.0),
        ("X-[1]", -1.0),
        ("X[1.]", 1.0),
        ("X[0.5+0.5]", 1.0),
        ("X1", 0.001),
        ("X1.", 1.0),
    ] {
        assert!((x(word) - wanted).abs() < 1e-12, "{word}: {}", x(word));
    }
}

/// Fanuc's lathe: nose 3 points to the chuck and to the axis, as an insert for turning along a bar does.
#[test]
fn the_nose_of_a_turning_tool_lies_where_fanuc_numbers_it() {
    let end = |nose: u32, side: &str| {
        let text = format!(
            "O1\nG21 G18 G97 S500 M3\nG98 F100\nG10 P10001 R1. Q{nose}\nT0101\nG0 X30. Z5.\n{side} G1 X20. Z2.\nZ-30.\nG40 X40.\nM30\n"
        );
        let found = places(&ops(&text, Dialect::FanucLatheA));
        let along = found.iter().find(|place| (place[2] + 30.0).abs() < 3.0).unwrap();
        2.0 * along[0]
    };
    // on the cylinder the imagined tip is on the programmed diameter; tip 2 is on the other side of the nose
    assert!((end(3, "G42") - 20.0).abs() < 1e-6, "{}", end(3, "G42"));
    assert!((end(4, "G42") - 20.0).abs() < 1e-6, "{}", end(4, "G42"));
    assert!((end(2, "G42") - 24.0).abs() < 1e-6, "{}", end(2, "G42"));
    assert!((end(8, "G42") - 20.0).abs() < 1e-6 && (end(0, "G42") - 22.0).abs() < 1e-6);
    // what a macro reads is what was written
    let text = "O1\nG21\nG10 P10001 R1. Q3\nG0 X#2301\nM30\n";
    assert!((2.0 * places(&ops(text, Dialect::FanucLatheA))[0][0] - 3.0).abs() < 1e-12);
}

#[test]
fn a_format_of_print_has_as_many_decimals_as_linuxcnc_writes() {
    let text = "#1=1.23456789\n(print,#1 %f#1 %d#1 %.2f#1)\nM2\n";
    let said = ops(text, Dialect::LinuxCnc).into_iter().find_map(|kind| match kind {
        OpKind::Message(text) => Some(text.to_string()),
        _ => None,
    });
    assert_eq!(said.unwrap().trim(), "1.234568 1.2346 1 1.23");
}

/// Fanuc: what a profile's blocks say of the side of the way is meant where G70 finishes it, as if they stood there alone.
#[test]
fn a_profile_is_finished_on_the_side_that_its_blocks_say() {
    let head = "O1\nG21 G18 G97 S500 M3\nG98 F100\nG10 P10001 R1. Q3\nT0101\nG0 X50. Z2.\n";
    let profile = "N10 G0 G42 X20.\nG1 Z-20.\nX40. Z-30.\nZ-40.\n";
    for last in ["N20 G40 X50.\n", "N20 X50.\n"] {
        let finish = "G71 U2. R1.\nG71 P10 Q20 U0.5 W0.1\n";
        let rest = "G70 P10 Q20\nM30\n";
        let cycle = format!("{head}{finish}{profile}{last}{rest}");
        let alone = format!("{head}{profile}{last}G40 G0 X50. Z2.\nM30\n");
        let [cycle, alone] = [cycle, alone].map(|text| places(&ops(&text, Dialect::FanucLatheA)));
        // from the profile's begin to the end of its last cylinder
        let wanted = &alone[1..alone.len() - 3];
        let found = cycle.windows(wanted.len()).filter(|part| part == &wanted).count();
        assert_eq!(found, 1, "{wanted:?} in {cycle:?}");
    }
}

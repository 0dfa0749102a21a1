//! Chip removal in programs: which repetitions throw chips off, at which levels, and what is
//! refused.
use canon::{OpKind, SpindleOrder};
use interp::{Chips, Cycles, DepthFrom, Dialect, Ops, Setup};

/// The program of Brother's description, as printed there.
const EXAMPLE: &str = "G90 G00 X0 Y0 Z450. M03 S5000\n\
                       G91 G81 X-10. Y-10. Z-90. R-50. P2. F3000. U2000 K6 E2\nM30\n";

fn brother() -> Setup {
    let cycles = Cycles { depth_from: Dialect::Brother.depth_from(), ..Cycles::default() };
    Setup { dialect: Dialect::Brother, cycles, ..Setup::default() }
}

/// The operations from the cycle on, a word each: heights, `hole`, `wait`, `throw` at a speed, then
/// another.
fn story(program: &str, setup: &Setup) -> (Vec<String>, Vec<String>) {
    let mut ops = Ops::new(program.as_bytes(), setup);
    let line = program.lines().take_while(|l| !l.contains("G8")).count() as u32 + 1;
    let words = ops.by_ref().filter(|op| op.span.line == line).filter_map(|op| match op.kind {
        OpKind::Rapid { to } => {
            Some(format!("to {} {}", to.linear[0].value(), to.linear[2].value()))
        }
        OpKind::Line { to, .. } => Some(format!("cut {}", to.linear[2].value())),
        OpKind::Hole(_) => Some("hole".into()),
        OpKind::Tap(tap) => Some(format!("tap {}", tap.bottom.value())),
        OpKind::Dwell { time } => Some(format!("wait {}", time.value())),
        OpKind::Spindle { order: SpindleOrder::ThrowChips(c), .. } => {
            let rpm = [c.throw, c.then].map(|s| s.in_rpm().round());
            Some(format!(
                "throw {} then {} from {}{}",
                rpm[0],
                rpm[1],
                c.axis.letter(),
                c.level.value()
            ))
        }
        _ => None,
    });
    let words = words.collect();
    (words, ops.diagnostics().iter().map(|d| format!("{} {}", d.code, d.message)).collect())
}

#[test]
fn the_example_drills_from_450_over_400_to_360_and_throws_chips_after_2_4_and_6() {
    let (words, found) = story(EXAMPLE, &brother());
    assert!(found.is_empty(), "{found:?}");
    let mut wanted = Vec::new();
    for hole in 1..=6 {
        let x = -10 * hole;
        wanted.extend(["hole".into(), format!("to {x} 450"), format!("to {x} 400")]);
        wanted.extend(["cut 360".into(), "wait 2".into()]);
        if hole % 2 == 0 {
            wanted.push("throw -2000 then 5000 from Z400".into());
        }
        wanted.push(format!("to {x} 450"));
    }
    assert_eq!(words, wanted);
}

#[test]
fn where_z_counts_from_r_the_same_hole_ends_at_310() {
    let mut setup = brother();
    setup.cycles.depth_from = DepthFrom::RPlane;
    let (words, _) = story(EXAMPLE, &setup);
    assert!(words.contains(&"cut 310".into()), "{words:?}");
}

#[test]
fn after_a_tap_the_spindle_is_to_stand() {
    let program = "G90 G0 X0 Y0 Z30 S500 M3\nG91 G84 X10 Z-40 R-20 F500 U300 K2 E1\nM30\n";
    let (words, found) = story(program, &brother());
    assert!(found.is_empty(), "{found:?}");
    let one = |x| {
        vec![
            format!("to {x} 30"),
            format!("to {x} 10"),
            "tap -10".into(),
            "throw -300 then 0 from Z10".into(),
            format!("to {x} 30"),
        ]
    };
    assert_eq!(words, [one(10), one(20)].concat());
}

#[test]
fn without_an_interval_or_with_0_no_chips_are_thrown() {
    for words in ["U2000 K6", "U2000 K6 E0", "U0 K6 E2", "K6"] {
        let program = EXAMPLE.replace("U2000 K6 E2", words);
        let (said, _) = story(&program, &brother());
        assert!(said.iter().all(|w| !w.starts_with("throw")), "{words}: {said:?}");
        assert_eq!(said.iter().filter(|w| *w == "hole").count(), 6, "{words}");
    }
}

#[test]
fn blocks_that_repeat_the_cycle_go_on_counting() {
    let program = "G90 G0 X0 Y0 Z450. M3 S5000\nG90 G81 X1 Z360 R400 F3000 U2000 E2\nX2\nX3\nX4\nG81 X5 Z360 R400\nM30\n";
    let setup = brother();
    let mut ops = Ops::new(program.as_bytes(), &setup);
    let lines: Vec<_> = ops
        .by_ref()
        .filter(|op| matches!(op.kind, OpKind::Spindle { order: SpindleOrder::ThrowChips(_), .. }))
        .map(|op| op.span.line)
        .collect();
    assert_eq!(lines, [3, 5], "the second and the fourth; the new G81 begins anew");
}

#[test]
fn the_speed_that_throws_chips_is_below_s_and_not_negative() {
    for (word, code) in [("U5000", "I0567"), ("U6000", "I0567"), ("U-1", "I0565")] {
        let (_, found) = story(&EXAMPLE.replace("U2000", word), &brother());
        assert!(found.iter().any(|f| f.starts_with(code)), "{word}: {found:?}");
    }
    let (_, found) = story(&EXAMPLE.replace(" M03", ""), &brother());
    assert!(found.iter().any(|f| f.starts_with("I0568")), "{found:?}");
    let (_, found) = story(&EXAMPLE.replace("U2000 ", ""), &brother());
    assert!(found.iter().any(|f| f.starts_with("I0563")), "{found:?}");
}

#[test]
fn in_another_dialect_the_words_need_the_machines_setting() {
    let program =
        "G90 G0 X0 Y0 Z450. M3 S5000\nG91 G81 G98 X-10. Z-40. R-50. F3000. U2000 L4 E2\nM30\n";
    let (_, found) = story(program, &Setup::default());
    assert!(!found.is_empty(), "U and E without the setting");
    let chips = Some(Chips { rpm: 1000.0, every: 1 });
    let cycles = Cycles { chip_removal: chips, ..Cycles::default() };
    let setup = Setup { cycles, ..Setup::default() };
    let throws = |program: &str| {
        let (words, found) = story(program, &setup);
        assert!(found.is_empty(), "{found:?}");
        words.into_iter().filter(|w| w.starts_with("throw")).collect::<Vec<_>>()
    };
    assert_eq!(throws(program), vec!["throw -2000 then 5000 from Z400"; 2]);
    assert_eq!(
        throws(&program.replace("U2000 L4 E2", "L4")),
        vec!["throw -1000 then 5000 from Z400"; 4]
    );
}

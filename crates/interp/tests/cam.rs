//! Cam grinding in programs: the document's blocks, the neutral ones, and what is refused.
use canon::{CamOrder, OpKind};
use interp::{Dialect, Ops, Setup};

fn story(program: &str, dialect: Dialect) -> (Vec<String>, Vec<&'static str>) {
    let setup = Setup { dialect, ..Setup::default() };
    let mut ops = Ops::new(program.as_bytes(), &setup);
    let words = ops.by_ref().filter_map(|op| match op.kind {
        OpKind::Cam(CamOrder::Select { profile, phase, centre, .. }) => {
            Some(format!("follow {profile} at {}° about {}", phase.in_deg(), centre.value()))
        }
        OpKind::Cam(CamOrder::Deselect) => Some("follow nothing".into()),
        OpKind::Cam(CamOrder::Compensate) => Some("compensate".into()),
        OpKind::Cam(CamOrder::ResetSampling) => Some("forget".into()),
        OpKind::Cam(CamOrder::StartSampling) => Some("sample".into()),
        OpKind::Cam(CamOrder::StorePhase) => Some("keep".into()),
        OpKind::Cam(CamOrder::Grind { stock, per_turn, rate, spin }) => Some(format!(
            "grind {} by {} at {} a turn, S{}",
            stock.value(),
            per_turn.value(),
            rate.value(),
            spin.in_rpm().round()
        )),
        OpKind::Cam(CamOrder::SparkOut { spin, turns }) => {
            Some(format!("turn {turns} times, S{}", spin.in_rpm().round()))
        }
        _ => None,
    });
    let words = words.collect();
    (words, ops.diagnostics().iter().filter(|d| d.is_error()).map(|d| d.code).collect())
}

#[test]
fn the_document_s_two_programs_mean_what_it_says() {
    let measure = "N110 G51 P1234\nN120 G52\nN130 G53 G04 S10 P2\nN140 G55\nM30\n";
    let (words, errors) = story(measure, Dialect::Toyoda);
    assert_eq!(errors, [""; 0]);
    assert_eq!(
        words,
        ["follow 1234 at 0° about 0", "forget", "sample", "turn 2 times, S10", "keep"]
    );
    let grind = "N010 G51 P1234\nN020 G50\nN030 G01 X-0.1 F0.1 R0.1 S10\nN040 G04 S10 P2\nM30\n";
    let (words, errors) = story(grind, Dialect::Toyoda);
    assert_eq!(errors, [""; 0]);
    assert_eq!(
        words,
        [
            "follow 1234 at 0° about 0",
            "compensate",
            "grind 0.1 by 0.1 at 0.1 a turn, S10",
            "turn 2 times, S10"
        ]
    );
}

#[test]
fn the_neutral_codes_mean_the_same_in_every_dialect() {
    let program = "G151 P7 R30\nG152\nG153\nG154 S60 P2\nG155\nG150\nG154 X-0.2 F0.05 R0.1\nG154 P3\nG151 P0\nM30\n";
    let (words, errors) = story(program, Dialect::LinuxCnc);
    assert_eq!(errors, [""; 0]);
    assert_eq!(
        words,
        [
            "follow 7 at 30° about 0",
            "forget",
            "sample",
            "turn 2 times, S60",
            "keep",
            "compensate",
            "grind 0.2 by 0.05 at 0.1 a turn, S60",
            "turn 3 times, S60",
            "follow nothing"
        ]
    );
}

#[test]
fn in_the_other_dialects_g55_is_a_work_offset_still() {
    let (words, errors) = story("G55\nG0 X1\nM30\n", Dialect::LinuxCnc);
    assert!(words.is_empty() && errors.is_empty());
}

#[test]
fn outside_of_cam_mode_g01_and_g04_are_what_they_always_are() {
    let (words, errors) = story("G01 X-1 F100\nG04 P0.5\nM30\n", Dialect::Toyoda);
    assert!(words.is_empty() && errors.is_empty(), "{words:?} {errors:?}");
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let of = |block: &str| story(&format!("G151 P7\n{block}\nM30\n"), Dialect::LinuxCnc).1;
    assert_eq!(of("G154 X-0.1 F0.05"), ["I1103"]); // no speed
    assert_eq!(of("G154 S60"), ["I1104"]); // neither X nor P
    assert_eq!(of("G154 X0.1 F0.05 S60"), ["I1105"]); // away from the work
    assert_eq!(of("G154 X-0.1 S60"), ["I1106"]); // no infeed
    assert_eq!(of("G154 X-0.1 F0.1 R0.05 S60"), ["I1107"]); // not within a turn
    assert_eq!(of("G151"), ["I1102"]);
    assert_eq!(story("G150\nM30\n", Dialect::LinuxCnc).1, ["I1101"]);
}

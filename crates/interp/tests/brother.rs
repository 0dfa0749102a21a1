//! Brother's everyday words: G77 and G78 (synchronised tapping), G100 (non-stop tool change), and
//! taps without M3.
use canon::{Op, OpKind, Tap};
use diag::Diagnostic;
use interp::{Dialect, Ops, Setup, example_setup};
use proptest::prelude::*;
use test_support::size;

fn setup() -> Setup {
    example_setup(Dialect::Brother)
}

fn ops(program: &str) -> (Vec<Op>, Vec<Diagnostic>) {
    let setup = setup();
    let mut ops = Ops::new(program.as_bytes(), &setup);
    let all = ops.by_ref().collect();
    (all, ops.diagnostics())
}

fn errors(program: &str) -> Vec<&'static str> {
    ops(program).1.iter().filter(|d| d.is_error()).map(|d| d.code).collect()
}

fn taps(program: &str) -> Vec<Tap> {
    let (ops, found) = ops(program);
    let errors: Vec<_> = found.iter().filter(|d| d.is_error()).collect();
    assert!(errors.is_empty(), "{errors:?}");
    ops.into_iter()
        .filter_map(|op| match op.kind {
            OpKind::Tap(tap) => Some(tap),
            _ => None,
        })
        .collect()
}

#[test]
fn g77_taps_by_its_pitch_at_its_own_speed_without_m3_before() {
    let taps = taps("T2 M6\nG0 G43 H2 Z30\nG77 X10 Y20 Z-15 R2 I1.25 S3000 L6000\nX30\nG80\nM30\n");
    assert_eq!(taps.len(), 2);
    for tap in &taps {
        assert!((tap.lead.value() - 1.25).abs() < 1e-12);
        assert!((tap.spin.in_rpm() - 3000.0).abs() < 1e-9);
        assert!((tap.return_spin.in_rpm() - 6000.0).abs() < 1e-9);
    }
    assert!((taps[1].start.linear[0].value() - 30.0).abs() < 1e-12);
}

#[test]
fn the_pitch_is_in_mm_and_the_threads_are_per_inch_whatever_the_unit_of_the_program() {
    let inch =
        taps("G20\nT2 M6\nG0 G43 H2 Z1\nG77 X1 Y1 Z-.5 R.1 J20 S2000\nG77 X2 I1\nG80\nM30\n");
    assert!((inch[0].lead.value() - 25.4 / 20.0).abs() < 1e-12);
    assert!((inch[1].lead.value() - 1.0).abs() < 1e-12);
}

#[test]
fn g78_is_left_hand_and_q_pecks_and_k_repeats() {
    let taps = taps("T2 M6\nG0 G43 H2 Z30\nG91 G78 X10 Z-45 R-28 I1 Q5 P0.1 S1500 K3\nG80\nM30\n");
    assert_eq!(taps.len(), 3);
    assert!(taps.iter().all(|tap| tap.lead.value() == -1.0 && tap.peck.is_some()));
    assert!(taps.iter().all(|tap| (tap.dwell.value() - 0.1).abs() < 1e-12));
}

#[test]
fn a_tap_of_g84_turns_the_spindle_itself_where_s_is_known() {
    assert_eq!(errors("T2 M6\nG0 G43 H2 Z30\nG84 X0 Z-10 R2 F1000 S1000\nG80\nM30\n"), [""; 0]);
    assert_eq!(errors("T2 M6\nG0 G43 H2 Z30\nG84 X0 Z-10 R2 F1000\nG80\nM30\n"), ["I0597"]);
    // M3 of the drill before it is no hindrance to a left-hand thread
    assert_eq!(errors("M3 S500\nG78 X0 Z-10 R2 I1 S1000\nG80\nM30\n"), [""; 0]);
}

#[test]
fn g100_changes_the_tool_starts_the_spindle_and_moves_over_before_it_goes_down() {
    let short = "G90 G54\nG100 T1 X10 Y20 G43 Z30 H1 S3000 M3 L2\nM30\n";
    let long = "G90 G54\nT1 M6\nS3000 M3\nG43 H1\nT2\nG0 X10 Y20\nG0 Z30\nM30\n";
    let kinds = |program: &str| -> Vec<OpKind> {
        let (ops, found) = ops(program);
        assert!(found.iter().all(|d| !d.is_error()), "{found:?}");
        ops.into_iter()
            .map(|op| op.kind)
            .filter(|kind| !matches!(kind, OpKind::SelectTool { .. }))
            .collect()
    };
    assert_eq!(kinds(short), kinds(long));
}

#[test]
fn what_g100_and_g77_need_is_said() {
    assert_eq!(errors("G100 X10 Y20\nM30\n"), ["I0595"]);
    assert_eq!(errors("G100 T1 M6 X10\nM30\n"), ["I0596"]);
    assert_eq!(errors("G77 X0 Z-10 R2 I1 J20 S1000\nG80\nM30\n"), ["I0593"]);
    assert_eq!(errors("G77 X0 Z-10 R2 S1000\nG80\nM30\n"), ["I0594"]);
    assert_eq!(errors("G77 X0 Z-10 R2 I-1 S1000\nG80\nM30\n"), ["I0592"]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: size::of(64, 1280), ..ProptestConfig::default() })]

    /// The same thread, written in either way.
    #[test]
    fn g77_by_its_pitch_is_g84_by_its_feed(
        pitch in 0.2..3.0f64, rpm in 100.0..6000.0f64, depth in 2.0..40.0f64, x in -50.0..50.0f64,
    ) {
        let (pitch, rpm) = ((pitch * 100.0).round() / 100.0, rpm.round());
        let head = format!("T2 M6\nG0 G43 H2 Z30\nS{rpm}\n");
        let one = taps(&format!("{head}G77 X{x:.3} Z-{depth:.3} R2 I{pitch}\nG80\nM30\n"));
        let feed = pitch * rpm;
        let other = taps(&format!("{head}G84 X{x:.3} Z-{depth:.3} R2 F{feed}\nG80\nM30\n"));
        let (one, other) = (&one[0], &other[0]);
        prop_assert!((one.lead.value() - other.lead.value()).abs() < 1e-9);
        prop_assert_eq!((one.bottom, one.start, one.spin), (other.bottom, other.start, other.spin));
    }
}

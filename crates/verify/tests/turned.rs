//! Turned threads as a bar has them, from motion made up for them: what is on the work and right
//! passes, and nothing else does.
//!
//! Limits are computed here from the formulas of ISO 965-1, tips of inserts from the geometry of a
//! V.
use bus::{Sample, Truth};
use canon::{
    Axis, Hand, Insert, InsertPoint, Op, OpKind, Position, Span, Threading, Tool, ToolKind,
    ToolLibrary,
};
use proptest::prelude::*;
use test_support::size;
use units::{Angle, Coordinate, Lead, LeadGrowth, Length, Time};
use verify::{Bar, Config, Feature, FeatureKind, Judge, TurnedThread};

const PERIOD: f64 = 250e-6;
/// Turns in a period: 1800 rpm.
const STEP: f64 = 0.0075 * 2.0;
const TOOL_LENGTH: f64 = 60.0;

/// A thread of a standard size, and how it is made.
#[derive(Clone, Debug)]
struct Case {
    nominal: f64,
    pitch: f64,
    hand: Hand,
    internal: bool,
    passes: u32,
    starts: u32,
    /// The tool is off its place by so much in X (away from the work is positive) and Z.
    shift: [f64; 2],
    /// Deeper by so much than the middle of the tolerance.
    deeper: f64,
    /// The bar is thicker than the middle of its tolerance by so much, in radius.
    thicker: f64,
    insert: Insert,
}

impl Default for Case {
    fn default() -> Self {
        Self {
            nominal: 20.0,
            pitch: 1.5,
            hand: Hand::Right,
            internal: false,
            passes: 6,
            starts: 1,
            shift: [0.0; 2],
            deeper: 0.0,
            thicker: 0.0,
            insert: Insert::threading(
                Angle::deg(60.0),
                Some(InsertPoint::Nose(Length::mm(0.1))),
                None,
            ),
        }
    }
}

impl Case {
    fn step_mean(&self) -> f64 {
        let steps: [f64; 6] = [2.8, 5.6, 11.2, 22.4, 45.0, 90.0];
        let step = steps.windows(2).find(|s| s[0] < self.nominal && self.nominal <= s[1]).unwrap();
        (step[0] * step[1]).sqrt()
    }

    /// Radius of bar or bore, and of the tip, in the middle of 6g or 6H.
    fn radii(&self) -> [f64; 2] {
        let (d, p) = (self.nominal, self.pitch);
        let h = 0.75_f64.sqrt() * p;
        let td2 = 0.090 * p.powf(0.4) * self.step_mean().powf(0.1);
        let nose = match self.insert.point {
            Some(InsertPoint::Nose(radius)) => radius.value(),
            _ => 0.0,
        };
        if self.internal {
            let bore = d - 1.25 * h + 0.230 * p.powf(0.7) / 2.0;
            let pitch_diameter = d - 0.75 * h + 1.32 * td2 / 2.0;
            [bore / 2.0, pitch_diameter / 2.0 + h / 2.0 - nose + self.deeper]
        } else {
            let es = 0.015 + 0.011 * p;
            let bar = d - es - (0.180 * p.powf(2.0 / 3.0) - 0.00315 / p.sqrt()) / 2.0;
            let pitch_diameter = d - 0.75 * h - es - td2 / 2.0;
            [bar / 2.0 + self.thicker, pitch_diameter / 2.0 - h / 2.0 + nose - self.deeper]
        }
    }

    fn judged(&self) -> (TurnedThread, verify::Verdict) {
        let feature = self.feature();
        let FeatureKind::Turned(thread) = feature.kind else { panic!("{feature:?}") };
        (*thread, feature.verdict)
    }

    /// Ten turns from the face on; the last one is the run-out.
    fn feature(&self) -> Feature {
        let [before, tip] = self.radii();
        let way = if self.internal { -1.0 } else { 1.0 };
        let (solid, bore) = if self.internal { (before + 10.0, before) } else { (before, 0.0) };
        let bar = Bar {
            radius: Length::mm(solid),
            bore: Length::mm(bore),
            face: Length::ZERO,
            rear: Length::mm(-14.0 * self.pitch * f64::from(self.starts)),
        };
        let tool = Tool {
            number: 31,
            pocket: 1,
            length: Length::mm(TOOL_LENGTH),
            diameter: Length::ZERO,
            kind: ToolKind::Insert(self.insert),
            description: String::new(),
            wear: canon::ToolWear::default(),
            life: canon::ToolLife::default(),
            body: canon::Body::default(),
            stand_in: false,
        };
        let config = Config { bar: Some(bar), ..Config::new(ToolLibrary::new([tool])) };
        let mut judge = Judge::new(config);
        let lead = self.pitch * f64::from(self.starts);
        let [x_off, z_off] = [self.shift[0] * way, self.shift[1]];
        let axes = |x: f64, z: f64| {
            let at = [x, 0.0, z + TOOL_LENGTH].map(Length::mm);
            Position { linear: at, ..Position::default() }
        };
        let (from, to) = (3.0 * lead, -10.0 * lead);
        let clear = before + way;
        let (mut op, mut time, mut whole) = (0, 0.0, 0.0);
        for start in 0..self.starts {
            for pass in 1..=self.passes {
                let share = (f64::from(pass) / f64::from(self.passes)).sqrt();
                let x = before + share * (tip - before);
                let order = Threading {
                    to: axes(x, to),
                    lead: Lead::mm_per_rev(lead),
                    growth: LeadGrowth::ZERO,
                    start_angle: Angle::rev(f64::from(start) / f64::from(self.starts)),
                    axis: Axis::Z,
                    surface: Length::mm(TOOL_LENGTH),
                };
                let kinds = [
                    OpKind::Rapid { to: axes(clear, from) },
                    OpKind::Rapid { to: axes(x, from) },
                    OpKind::Threading(order),
                    OpKind::Rapid { to: axes(clear, to) },
                ];
                for (k, kind) in (0..).zip(kinds) {
                    judge.op(op + k, &Op { span: Span::default(), kind });
                }
                // in the air to the depth, along the thread, out where it ends
                let turns = (from - to) / lead;
                let mut see = |op: u32, x: f64, z: f64, turn: f64| {
                    let mut sample = Sample::default();
                    sample.report.op = op;
                    sample.feedback.time = Time::s(time);
                    sample.feedback.tool = Some(31);
                    let mut truth = Truth::default();
                    truth.axes[0] = Coordinate::new(x + x_off);
                    truth.axes[2] = Coordinate::new(z + z_off + TOOL_LENGTH);
                    truth.spindles[0] =
                        Angle::rev(self.hand.sign() * (whole + turn) + order.start_angle.value());
                    sample.truth = Some(truth);
                    judge.sample(&sample);
                    time += PERIOD;
                };
                for k in 0..20 {
                    see(
                        op + 1,
                        clear + f64::from(k) / 20.0 * (x - clear),
                        from,
                        f64::from(k) * 0.01 - 0.2,
                    );
                }
                let count = (turns / STEP) as u32;
                (0..count).for_each(|k| {
                    see(op + 2, x, from - lead * STEP * f64::from(k), STEP * f64::from(k));
                });
                for k in 0..20 {
                    see(
                        op + 3,
                        x + f64::from(k) / 20.0 * (clear - x),
                        to,
                        turns + f64::from(k) * 0.01,
                    );
                }
                for k in 0..20 {
                    let share = f64::from(k) / 20.0;
                    see(op + 3, clear, to + share * (from - to), turns + 0.2 + share);
                }
                op += 4;
                whole += (turns + 3.0).ceil();
            }
        }
        judge.finish().remove(0)
    }
}

fn mm(lengths: [Length; 2]) -> [f64; 2] {
    lengths.map(Length::value)
}

#[test]
fn a_thread_in_the_middle_of_its_tolerance_is_good_and_measured() {
    let (thread, verdict) = Case::default().judged();
    assert!(verdict.is_pass(), "{verdict:?} {:?}", thread.sizes);
    assert_eq!((thread.size.as_deref(), thread.class), (Some("M20x1.5"), "6g"));
    let sizes = thread.sizes.unwrap();
    // ISO 965-2: 19.732 to 19.968, 18.854 to 18.994
    assert!(mm(sizes.pitch).iter().all(|d| (d - 18.924).abs() < 0.004), "{sizes:?}");
    assert!(mm(sizes.major).iter().all(|d| (d - 19.85).abs() < 0.004), "{sizes:?}");
    assert!(sizes.pitch_error < Length::um(0.5) && sizes.flank_error < Length::um(1.0));
    // from the face to Z−15, where the point stands half a groove further
    assert!((15.0..16.0).contains(&sizes.full_length.value()), "{sizes:?}");
    assert!(thread.contact.unwrap() > 0.98, "but for the one at the face");
}

#[test]
fn an_insert_that_passes_the_bar_by_has_cut_nothing() {
    let (thread, verdict) = Case { shift: [1.5, 0.0], ..Case::default() }.judged();
    let reason = verdict.reason().unwrap();
    assert!(reason.starts_with("not cut: the insert passed the bar of ⌀19.8"), "{reason}");
    assert!(thread.groove_depth.unwrap() < Length::ZERO && thread.sizes.is_none());
}

#[test]
fn a_thread_whole_turns_off_its_place_is_none_that_was_ordered() {
    // the same helix, further along the bar: it winds into the same groove
    let verdict =
        |pitches: f64| Case { shift: [0.0, -pitches * 1.5], ..Case::default() }.judged().1;
    assert!(verdict(0.0).is_pass());
    for pitches in 3..5 {
        let verdict = verdict(f64::from(pitches));
        let reason = verdict.reason().unwrap();
        assert!(reason.contains("beyond the end of its last block"), "{reason}");
    }
    // only the last turns of it meet the bar
    assert_eq!(verdict(11.0).name(), "fail");
}

#[test]
fn too_deep_and_too_shallow_fail_with_the_diameter_found() {
    let case = |deeper| Case { deeper, ..Case::default() }.judged().1;
    let deep = case(0.045);
    assert!(deep.reason().unwrap().contains("pitch diameter 18.834 mm, 18.854 to 18.994 mm in M20x1.5-6g: the groove is at least 0.010 mm too deep"), "{deep:?}");
    let shallow = case(-0.045);
    assert!(shallow.reason().unwrap().contains("too shallow"), "{shallow:?}");
    assert!(case(0.03).is_pass() && case(-0.03).is_pass());
}

#[test]
fn a_full_profile_cuts_the_crest_of_a_bar_that_is_too_thick() {
    let thread = |crest_height| {
        let insert = Insert { crest_height, ..Case::default().insert };
        Case { insert, thicker: 0.075, ..Case::default() }.judged()
    };
    // 10 mm of radius: the bar is not turned before
    let (partial, verdict) = thread(None);
    assert!((partial.before.unwrap().value() - 20.002).abs() < 0.001, "{:?}", partial.before);
    let reason = verdict.reason().unwrap();
    assert!(
        reason.contains(
            "major diameter 20.002 mm, 19.732 to 19.968 mm in M20x1.5-6g: turn the bar to it before"
        ),
        "{reason}"
    );
    let [before, tip] = Case::default().radii();
    let (full, verdict) = thread(Some(Length::mm(before - tip)));
    assert!(verdict.is_pass(), "{verdict:?}");
    assert!(mm(full.sizes.unwrap().major).iter().all(|d| (d - 2.0 * before).abs() < 1e-6));
}

#[test]
fn two_starts_side_by_side_are_one_thread_of_half_the_lead() {
    let (thread, verdict) = Case { starts: 2, ..Case::default() }.judged();
    assert_eq!((thread.starts, thread.lead.value()), (2, 3.0));
    assert!(verdict.is_pass(), "{verdict:?} {:?}", thread.sizes);
}

#[test]
fn an_insert_of_55_degrees_is_not_judged_by_limits_of_60() {
    let insert = Insert { angle: Angle::deg(55.0), ..Case::default().insert };
    let (thread, verdict) = Case { insert, ..Case::default() }.judged();
    assert_eq!(verdict.name(), "not judged", "{verdict:?}");
    assert!(verdict.reason().unwrap().contains("55°") && thread.limits.is_none());
}

#[test]
fn a_size_that_no_standard_has_is_not_judged() {
    let (thread, verdict) = Case { nominal: 19.0, ..Case::default() }.judged();
    assert_eq!(verdict.name(), "not judged", "{verdict:?}");
    assert!(thread.sizes.is_some(), "measured all the same");
}

/// Sizes with their pitch, coarse and fine.
const SIZES: [(f64, f64); 9] = [
    (8.0, 1.25),
    (10.0, 1.5),
    (12.0, 1.75),
    (16.0, 2.0),
    (20.0, 1.5),
    (20.0, 2.5),
    (24.0, 1.0),
    (30.0, 3.5),
    (36.0, 2.0),
];

fn any_case() -> impl Strategy<Value = Case> {
    (0..SIZES.len(), any::<bool>(), any::<bool>(), 2..7_u32).prop_map(
        |(size, left, internal, passes)| {
            let (nominal, pitch) = SIZES[size];
            let share = if internal { 0.05 } else { 0.125 };
            let point = Some(InsertPoint::Nose(Length::mm(share * pitch)));
            let insert = Insert { point, ..Case::default().insert };
            let hand = if left { Hand::Left } else { Hand::Right };
            Case { nominal, pitch, hand, internal, passes, insert, ..Case::default() }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: size::of(40, 800), ..ProptestConfig::default() })]

    #[test]
    fn a_thread_of_any_size_and_hand_on_the_work_is_good(case in any_case(), off in -0.3..0.3) {
        // within a third of the half tolerance each way
        let deeper = off * 0.045 * case.pitch.powf(0.4) * case.step_mean().powf(0.1);
        let case = Case { deeper, ..case };
        let (thread, verdict) = case.judged();
        prop_assert!(verdict.is_pass(), "{case:?}: {verdict:?}");
        prop_assert_eq!(thread.hand, case.hand);
        prop_assert_eq!(thread.internal, case.internal);
    }

    #[test]
    fn a_tool_path_off_the_work_is_never_good(
        // 1.5 pitches may be left uncut, and the groove reaches half a pitch beyond the point that
        // cuts it
        case in any_case(), x in 0.12..3.0_f64, z in 2.1..20.0_f64, how in 0..4,
    ) {
        let shift = match how {
            0 => [x, 0.0],                    // too far out: too shallow, or in the air
            1 => [-x.min(0.4), 0.0],          // too far in
            2 => [0.0, z * case.pitch],       // starts and ends in the air
            _ => [0.0, -z * case.pitch],      // begins inside of the work
        };
        let case = Case { shift, ..case };
        let (thread, verdict) = case.judged();
        prop_assert!(!verdict.is_pass(), "{case:?}: {verdict:?} {:?}", thread.sizes);
        prop_assert_eq!(verdict.name(), "fail");
    }
}

//! One bar, and what operations after one another leave of its threads: for each that must spoil
//! one, a neighbour that must not.
use crate::lathe::{BACK, BORE, DRILL_8, DRILL_19, FULL, GROOVE, Lathe, NEUTRAL, PARTIAL, TURN};
use canon::Axis;
use verify::FeatureKind;

/// An attack: what is done, and the verdicts expected of the turned threads.
type Attack = (&'static str, fn(Lathe) -> Lathe, &'static [&'static str]);

const GOOD: &[&str] = &["pass"];
const BAD: &[&str] = &["fail"];
const OPEN: &[&str] = &["not judged"];

fn hold(attacks: &[Attack]) {
    let mut wrong = String::new();
    for (name, work, expected) in attacks {
        let found = work(Lathe::new().line(1)).verdicts();
        let names: Vec<_> = found.iter().map(|(_, verdict, _)| *verdict).collect();
        if names != *expected {
            wrong += &format!("{name}: expected {expected:?}, found {found:?}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn an_ordinary_move_before_a_thread_takes_nothing_off_it() {
    hold(&[
        ("nothing before it", |l| l.m20(), GOOD),
        (
            "a millimetre back in the air",
            |l| l.with(TURN).rapid(9.2, 3.0).feed(9.2, 2.0).feed(9.2, 3.0).rapid(30.0, 50.0).m20(),
            GOOD,
        ),
        (
            "a micrometre back at the face",
            |l| {
                l.with(TURN)
                    .rapid(9.0, 1.0)
                    .feed(9.0, 0.01)
                    .feed(9.0, 0.011)
                    .rapid(30.0, 50.0)
                    .m20()
            },
            GOOD,
        ),
        ("faced at its zero", |l| l.faced(0.0).m20(), GOOD),
        ("faced by a millimetre's tenth", |l| l.faced(-0.1).m20(), GOOD),
        ("a chamfer of 1 mm", |l| l.chamfer(1.0).m20(), GOOD),
        ("a chamfer of 1.2 mm", |l| l.chamfer(1.2).m20(), GOOD),
        (
            "a chamfer and away along a slant",
            |l| {
                l.with(TURN).rapid(9.0, 2.0).feed(9.0, 0.0).feed(10.0, -1.0).rapid(30.0, 50.0).m20()
            },
            GOOD,
        ),
        (
            "a chamfer with the threading insert",
            |l| l.with(FULL).rapid(9.2, 1.0).feed(9.2, 0.2).feed(9.2, 1.0).rapid(30.0, 50.0).m20(),
            GOOD,
        ),
        (
            "turned to size, and back along the bar",
            |l| {
                l.with(TURN)
                    .rapid(9.93, 2.0)
                    .feed(9.93, -30.0)
                    .feed(9.93, 2.0)
                    .rapid(30.0, 50.0)
                    .with(PARTIAL)
                    .passes(&[9.6, 9.25, 9.015], -25.0)
            },
            GOOD,
        ),
        (
            "turned to size by a neutral insert",
            |l| {
                l.turned(NEUTRAL, 9.93, [2.0, -30.0])
                    .with(PARTIAL)
                    .passes(&[9.6, 9.25, 9.015], -25.0)
            },
            GOOD,
        ),
        (
            "its leading edge goes into the face",
            |l| l.with(NEUTRAL).rapid(11.0, 0.4).feed(0.0, 0.4).rapid(30.0, 50.0).m20(),
            BAD,
        ),
        (
            "behind its end, with an insert that points to the free end",
            |l| l.turned(BACK, 9.5, [-40.0, -30.0]).m20(),
            GOOD,
        ),
        (
            "the grooving insert stands before the face",
            |l| l.with(GROOVE).rapid(5.0, 1.0).feed(4.0, 1.0).rapid(30.0, 50.0).m20(),
            GOOD,
        ),
        ("the bar was turned too thin before", |l| l.turned(TURN, 9.2, [2.0, -30.0]).m20(), OPEN),
        (
            "an insert that points to the free end, along the bar",
            |l| l.turned(BACK, 9.2, [-26.0, 2.0]).m20(),
            OPEN,
        ),
    ]);
}

#[test]
fn blocks_in_the_same_groove_are_one_thread_as_it_stands_at_the_end() {
    hold(&[
        (
            "roughed and finished",
            |l| l.with(FULL).passes(&[9.6, 9.2], -25.0).line(2).with(FULL).passes(&[9.015], -25.0),
            GOOD,
        ),
        ("roughed only", |l| l.with(FULL).passes(&[9.6, 9.2], -25.0), BAD),
        ("a spring pass", |l| l.m20().line(2).with(FULL).passes(&[9.015], -25.0), GOOD),
        (
            "two spring passes",
            |l| {
                let again = |l: Lathe| l.with(FULL).passes(&[9.015], -25.0);
                again(again(l.m20().line(2)).line(3))
            },
            GOOD,
        ),
        (
            "started a pitch earlier",
            |l| l.m20().line(2).with(FULL).pass(9.015, [7.5, -25.0], 1.5, 0.0),
            GOOD,
        ),
        (
            "roughed by a partial profile, finished by the full one",
            |l| l.with(PARTIAL).passes(&[9.6, 9.2], -25.0).line(2).m20(),
            GOOD,
        ),
        (
            "roughed half as long, finished whole",
            |l| l.with(FULL).passes(&[9.6, 9.2], -14.0).line(2).m20(),
            GOOD,
        ),
        (
            "each pass a block of its own, fed in",
            |l| {
                [9.6, 9.3, 9.015].into_iter().zip(1..).fold(l.with(FULL), |l, (x, line)| {
                    l.line(line).rapid(12.0, 6.0).feed(11.5, 6.0).pass(x, [6.0, -25.0], 1.5, 0.0)
                })
            },
            GOOD,
        ),
        (
            "turned to its size between roughing and finishing",
            |l| {
                l.with(PARTIAL)
                    .passes(&[9.6, 9.2], -25.0)
                    .line(2)
                    .turned(TURN, 9.93, [2.0, -30.0])
                    .line(3)
                    .with(PARTIAL)
                    .passes(&[9.015], -25.0)
            },
            GOOD,
        ),
        (
            "finished to a half only",
            |l| l.with(FULL).passes(&[9.6, 9.2], -25.0).line(2).with(FULL).passes(&[9.015], -11.0),
            &["fail", "pass"],
        ),
        (
            "finished in the air",
            |l| l.with(FULL).passes(&[9.6, 9.2], -25.0).line(2).with(FULL).passes(&[11.0], -25.0),
            &["fail", "fail"],
        ),
        (
            "two beside one another",
            |l| {
                l.with(FULL)
                    .passes(&[9.6, 9.25, 9.015], -20.0)
                    .line(2)
                    .groove(GROOVE, -29.0, 8.9)
                    .with(FULL)
                    .pass(9.6, [-27.0, -45.0], 1.5, 0.0)
                    .pass(9.015, [-27.0, -45.0], 1.5, 0.0)
            },
            &["pass", "pass"],
        ),
        (
            "two starts in two blocks",
            |l| {
                let start = |l: Lathe, start: f64| {
                    [9.6, 9.25, 9.015]
                        .into_iter()
                        .fold(l, |l, x| l.pass(x, [6.0, -30.0], 3.0, start))
                };
                let first = start(l.with(FULL), 0.0);
                start(first.line(2).feed(12.0, 6.0), 0.5)
            },
            GOOD,
        ),
    ]);
}

#[test]
fn another_groove_on_the_same_place_cuts_across_it() {
    hold(&[
        (
            "half a pitch off",
            |l| l.m20().line(2).feed(12.0, 6.0).pass(9.015, [6.0, -25.0], 1.5, 0.5),
            &["fail", "fail"],
        ),
        (
            "three tenths of a pitch off",
            |l| l.m20().line(2).feed(12.0, 6.0).pass(9.015, [6.0, -25.0], 1.5, 0.3),
            &["fail", "fail"],
        ),
        (
            "a tenth of a pitch off",
            |l| l.m20().line(2).feed(12.0, 6.0).pass(9.015, [6.0, -25.0], 1.5, 0.1),
            BAD,
        ),
        (
            "half a pitch off in the same block",
            |l| {
                l.with(FULL).pass(9.015, [6.0, -25.0], 1.5, 0.0).pass(9.015, [6.0, -25.0], 1.5, 0.5)
            },
            BAD,
        ),
        (
            "another lead",
            |l| l.m20().line(2).pass(9.015, [6.0, -25.0], 2.0, 0.0),
            &["fail", "fail"],
        ),
        ("a left-hand one", |l| l.m20().line(2).backwards().m20(), &["fail", "fail"]),
        (
            "half a pitch off and in the air",
            |l| l.m20().line(2).feed(12.0, 6.0).pass(10.5, [6.0, -25.0], 1.5, 0.5),
            &["pass", "fail"],
        ),
        (
            "another lead behind it",
            |l| {
                l.with(FULL)
                    .passes(&[9.6, 9.25, 9.015], -20.0)
                    .line(2)
                    .groove(GROOVE, -30.0, 8.0)
                    .with(PARTIAL)
                    .pass(9.6, [-28.0, -50.0], 1.75, 0.0)
            },
            &["pass", "not judged"],
        ),
    ]);
}

#[test]
fn what_a_later_cut_takes_off_a_thread_spoils_it_and_what_it_takes_beside_does_not() {
    hold(&[
        ("turned off", |l| l.m20().line(2).turned(TURN, 9.0, [2.0, -30.0]), BAD),
        ("turned off in its first half", |l| l.m20().line(2).turned(TURN, 9.0, [2.0, -12.0]), BAD),
        (
            "its crests turned down too far",
            |l| l.m20().line(2).turned(TURN, 9.7, [2.0, -30.0]),
            BAD,
        ),
        (
            "its crests turned down within their limits",
            |l| l.m20().line(2).turned(TURN, 9.9, [2.0, -30.0]),
            GOOD,
        ),
        ("passed over its crests", |l| l.m20().line(2).turned(TURN, 10.02, [2.0, -30.0]), GOOD),
        ("turned behind it", |l| l.m20().line(2).turned(GROOVE, 9.0, [-31.0, -50.0]), GOOD),
        (
            "plunged behind it, with the trailing edge in it",
            |l| l.m20().line(2).turned(TURN, 9.0, [-28.0, -50.0]),
            BAD,
        ),
        ("grooved in its middle", |l| l.m20().line(2).groove(GROOVE, -13.0, 9.2), BAD),
        ("grooved by the turning insert", |l| l.m20().line(2).groove(TURN, -10.0, 9.2), BAD),
        (
            "a relief groove at its end, afterwards",
            |l| l.m20().line(2).groove(GROOVE, -25.0, 8.9),
            GOOD,
        ),
        (
            "a deep relief groove at its end, afterwards",
            |l| l.m20().line(2).groove(GROOVE, -25.0, 6.0),
            GOOD,
        ),
        ("a relief groove at its end, before", |l| l.groove(GROOVE, -26.0, 8.9).m20(), GOOD),
        (
            "a relief groove of 5 mm at its end, before",
            |l| l.groove(GROOVE, -26.0, 8.9).groove(GROOVE, -24.0, 8.9).m20(),
            GOOD,
        ),
        (
            "the bar thin in its last half, before",
            |l| l.turned(GROOVE, 8.9, [-13.0, -27.0]).m20(),
            BAD,
        ),
        ("a groove behind its end", |l| l.m20().line(2).groove(GROOVE, -31.0, 5.0), GOOD),
        ("a chamfer of 1 mm, afterwards", |l| l.m20().line(2).chamfer(1.0), GOOD),
        ("a chamfer of 1.5 mm, afterwards", |l| l.m20().line(2).chamfer(1.5), GOOD),
        ("a chamfer of 6 mm, afterwards", |l| l.m20().line(2).chamfer(6.0), BAD),
        ("faced by half a millimetre", |l| l.m20().line(2).faced(-0.5), GOOD),
        ("faced by five millimetres", |l| l.m20().line(2).faced(-5.0), BAD),
        (
            "a rapid through it",
            |l| {
                l.m20()
                    .line(2)
                    .with(TURN)
                    .rapid(12.0, -8.0)
                    .rapid(9.0, -8.0)
                    .rapid(9.0, -15.0)
                    .rapid(12.0, -15.0)
            },
            BAD,
        ),
        ("a hole of 8 mm through the bar", |l| l.m20().line(2).drilled(DRILL_8, -40.0), GOOD),
        ("a hole of 19 mm through the bar", |l| l.m20().line(2).drilled(DRILL_19, -40.0), BAD),
        (
            "a groove of an own thread in it",
            |l| l.m20().line(2).with(PARTIAL).rapid(12.0, -10.0).feed(9.0, -10.0).feed(12.0, -10.0),
            BAD,
        ),
    ]);
}

#[test]
fn what_is_parted_off_is_a_piece_of_its_own() {
    let part = |l: Lathe, z: f64| l.groove(GROOVE, z, 0.0);
    let cases: &[(&str, f64, &[&str])] = &[
        ("behind it", -40.0, &["pass"]),
        ("just behind its run-out", -30.0, &["pass"]),
        ("through its middle", -13.0, &["fail"]),
        ("through its beginning", -5.0, &["fail"]),
    ];
    for (name, z, expected) in cases {
        let found = part(Lathe::new().m20().line(2), *z).verdicts();
        let names: Vec<_> = found.iter().map(|(_, verdict, _)| *verdict).collect();
        assert_eq!(names, *expected, "{name}: {found:?}");
    }
    // the next part of the same bar
    let next = |l: Lathe| {
        l.line(3)
            .with(FULL)
            .pass(9.6, [-31.0, -50.0], 1.5, 0.0)
            .pass(9.25, [-31.0, -50.0], 1.5, 0.0)
            .pass(9.015, [-31.0, -50.0], 1.5, 0.0)
    };
    let found = next(part(Lathe::new().m20().line(2), -34.0)).verdicts();
    assert!(
        found.iter().all(|(_, verdict, _)| *verdict == "pass") && found.len() == 2,
        "{found:?}"
    );
    // where the part was there is air
    let found = part(Lathe::new().line(1).m20().line(2), -40.0).line(3).m20().verdicts();
    let names: Vec<_> = found.iter().map(|(line, verdict, _)| (*line, *verdict)).collect();
    assert_eq!(names, [(1, "pass"), (3, "fail")], "{found:?}");
}

#[test]
fn the_verdict_says_in_which_line_a_good_thread_was_destroyed_and_what_is_left() {
    let found = Lathe::new().line(1).m20().line(7).groove(GROOVE, -13.0, 9.2).verdicts();
    let (line, verdict, reason) = &found[0];
    assert_eq!((*line, *verdict), (1, "fail"));
    assert!(reason.starts_with("good when cut, destroyed in line 7: "), "{reason}");
    assert!(reason.contains("whole over 10.5"), "{reason}");
    let found = Lathe::new().line(1).m20().line(9).backwards().m20().verdicts();
    assert!(found[0].2.contains("destroyed in line 9"), "{found:?}");
    assert!(found[1].2.contains("cut across the thread of line 1"), "{found:?}");
}

#[test]
fn a_thread_within_a_bore_is_followed_like_one_outside() {
    let m20 = |l: Lathe| {
        [9.5, 9.8, 9.99].into_iter().fold(l.with(PARTIAL), |l, x| {
            // fed in from within
            l.rapid(8.0, 6.0).rapid(x, 6.0).inside(x, -25.0)
        })
    };
    let bored = |l: Lathe, r: f64, to: f64| {
        l.line(2).with(BORE).rapid(8.0, 2.0).feed(r, 2.0).feed(r, to).feed(8.0, to).rapid(8.0, 50.0)
    };
    let good = m20(Lathe::bored(9.25).line(1)).verdicts();
    let names = |found: &[(u32, &'static str, String)]| -> Vec<&str> {
        found.iter().map(|(_, verdict, _)| *verdict).collect()
    };
    let before = names(&good)[0];
    let after = bored(m20(Lathe::bored(9.25).line(1)), 9.7, -30.0).verdicts();
    assert_eq!(names(&after), ["fail"], "{after:?}");
    let after = bored(m20(Lathe::bored(9.25).line(1)), 9.24, -30.0).verdicts();
    assert_eq!(names(&after), [before], "{after:?}, {good:?}");
}

#[test]
fn threads_that_have_no_limits_are_not_judged_by_those_of_others() {
    hold(&[
        (
            "a spiral in the face",
            |l| {
                l.with(PARTIAL).rapid(12.0, 2.0).rapid(12.0, -0.3).waits().stretch(
                    [2.0, -0.3],
                    1.5,
                    0.0,
                    Axis::X,
                )
            },
            OPEN,
        ),
        (
            "a thread on the bar after a spiral in its face",
            |l| {
                l.with(PARTIAL)
                    .rapid(12.0, 2.0)
                    .rapid(12.0, -0.3)
                    .waits()
                    .stretch([2.0, -0.3], 1.5, 0.0, Axis::X)
                    .rapid(2.0, 5.0)
                    .rapid(30.0, 50.0)
                    .line(2)
                    .m20()
            },
            &["not judged", "pass"],
        ),
        (
            "a thread on the bar after a spiral in its face from within",
            |l| {
                l.with(PARTIAL)
                    .rapid(30.0, 5.0)
                    .rapid(2.0, 5.0)
                    .feed(2.0, -0.3)
                    .waits()
                    .stretch([9.0, -0.3], 1.5, 0.0, Axis::X)
                    .rapid(9.0, 5.0)
                    .rapid(30.0, 50.0)
                    .line(2)
                    .m20()
            },
            &["not judged", "pass"],
        ),
        (
            "an oval",
            |l| {
                let l = l.with(TURN).rapid(12.0, 2.0).rapid(9.8, 2.0);
                (1..80).fold(l, |l, k| {
                    let x = 9.7 + 0.1 * f64::from(k % 2);
                    l.stretch([x, 2.0 - 0.25 * f64::from(k)], 2.0, 0.0, Axis::Z)
                })
            },
            OPEN,
        ),
        (
            "an oval thread that is turned off",
            |l| {
                let l = l.with(TURN).rapid(12.0, 2.0).rapid(9.8, 2.0);
                (1..80)
                    .fold(l, |l, k| {
                        let x = 9.7 + 0.1 * f64::from(k % 2);
                        l.stretch([x, 2.0 - 0.25 * f64::from(k)], 2.0, 0.0, Axis::Z)
                    })
                    .rapid(12.0, -18.0)
                    .line(2)
                    .turned(TURN, 9.0, [2.0, -30.0])
            },
            OPEN,
        ),
    ]);
    // the spiral in the face has no side of a shaft or a bore, and no contact with either
    let features = Lathe::new()
        .with(PARTIAL)
        .rapid(12.0, 2.0)
        .rapid(12.0, -0.3)
        .waits()
        .stretch([2.0, -0.3], 1.5, 0.0, Axis::X)
        .features();
    let FeatureKind::Turned(thread) = &features[0].kind else { panic!("{features:?}") };
    assert!(!thread.internal && thread.contact.is_none(), "{thread:?}");
}

#[test]
fn a_spindle_that_turns_the_other_way_makes_a_left_hand_thread_and_its_name_says_so() {
    let features = Lathe::new().backwards().m20().features();
    let FeatureKind::Turned(thread) = &features[0].kind else { panic!("{features:?}") };
    assert!(thread.name().ends_with("left"), "{}", thread.name());
    assert_eq!(thread.class_and_size(), "M20x1.5-6g-LH");
}

#[test]
fn the_next_program_finds_the_threads_of_the_one_before() {
    // roughed by one, finished by the next
    let rough = Lathe::new().line(1).with(FULL).passes(&[9.6, 9.2], -25.0);
    let found = rough.next_program().line(4).with(FULL).passes(&[9.015], -25.0).verdicts();
    assert_eq!(found, [(4, "pass", String::new())]);
    // cut by one, turned off by the next: told there, in the line that did it
    let found =
        Lathe::new().m20().next_program().line(5).turned(TURN, 9.0, [2.0, -30.0]).verdicts();
    assert_eq!((found.len(), found[0].0, found[0].1), (1, 5, "fail"), "{found:?}");
    // left alone, it is not told again
    assert!(Lathe::new().m20().next_program().line(5).turned(TURN, 9.0, [-40.0, -50.0]).all_good());
    assert!(Lathe::new().m20().next_program().features().is_empty());
}

#[test]
fn each_thread_is_counted_once() {
    let rough = |l: Lathe| l.with(FULL).passes(&[9.6, 9.2], -25.0);
    let features = rough(Lathe::new().line(1)).line(2).m20().features();
    assert_eq!(features.len(), 1);
    let FeatureKind::Turned(thread) = &features[0].kind else { panic!("{features:?}") };
    assert_eq!((thread.passes, thread.passes_ordered), (5, 5));
    assert_eq!(thread.before.map(|d| d.value().round()), Some(20.0), "the bar before the first");
}

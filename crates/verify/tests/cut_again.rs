//! What turns with the work, cut again or taken off: threads, polygons and what is turned, each
//! after each other. Gears have theirs in `gear`, cams in the judge's own file.
use crate::lathe::{DRILL_8, DRILL_19, FULL, GROOVE, Lathe, TURN};

/// On a bar of 20 mm.
type Cut = fn(Lathe) -> Lathe;

fn hexagon(lathe: Lathe) -> Lathe {
    lathe.line(1).hexagon([2.0, -10.0], 0.0).line(2)
}

/// What is to be said of what is cut, by what; nothing: all is good.
fn hold(rows: &[(&str, Cut, &[&str])]) {
    let mut wrong = Vec::new();
    for (name, cut, says) in rows {
        let found = cut(Lathe::new()).wrong();
        let all = found.join("\n    ");
        let missing = says.iter().find(|said| !all.contains(**said));
        if found.is_empty() != says.is_empty() || missing.is_some() {
            wrong.push(format!("{name}: {missing:?} is not in\n    {all}"));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), rows.len(), wrong.join("\n"));
}

const OF_THE_HEXAGON: &str = "polygon of line 1: good when cut, destroyed in line 2: ";

#[test]
fn a_polygon_that_is_turned_grooved_faced_bored_or_parted_is_what_is_left_of_it() {
    hold(&[
        (
            "turned to less than its facets",
            |l| hexagon(l).turned(TURN, 8.0, [2.0, -12.0]),
            &[OF_THE_HEXAGON, "nothing is left of its facets"],
        ),
        (
            "turned over its first half",
            |l| hexagon(l).turned(TURN, 8.0, [2.0, -5.0]),
            &[OF_THE_HEXAGON, "its facets are left over"],
        ),
        (
            "its corners turned off",
            |l| hexagon(l).turned(TURN, 9.1, [2.0, -12.0]),
            &[OF_THE_HEXAGON, "18.2", "across corners are left", "at least (ISO 4759-1)"],
        ),
        ("a groove in its middle", |l| hexagon(l).groove(GROOVE, -7.0, 8.0), &[OF_THE_HEXAGON]),
        ("a groove in its corners", |l| hexagon(l).groove(GROOVE, -7.0, 8.9), &[OF_THE_HEXAGON]),
        ("faced by three millimetres", |l| hexagon(l).faced(-3.0), &[OF_THE_HEXAGON, "6.9"]),
        ("parted off in its middle", |l| hexagon(l).groove(GROOVE, -7.0, -0.2), &[OF_THE_HEXAGON]),
        ("bored through its facets", |l| hexagon(l).drilled(DRILL_19, -30.0), &[OF_THE_HEXAGON]),
        (
            "a rapid through it",
            |l| hexagon(l).with(TURN).rapid(12.0, -4.0).rapid(8.0, -4.0).rapid(12.0, -8.0),
            &[OF_THE_HEXAGON],
        ),
        (
            "turned thinner before",
            |l| l.turned(TURN, 8.0, [2.0, -12.0]).hexagon([2.0, -10.0], 0.0),
            &[
                "polygon of line 0: the bar was turned or bored below its facets before: nothing is left",
            ],
        ),
        (
            "a groove before",
            |l| l.groove(GROOVE, -7.0, 8.0).hexagon([2.0, -10.0], 0.0),
            &["below its facets before: its facets are left over 6.9"],
        ),
        // what leaves it good
        (
            "its corners finished from before its face",
            |l| {
                hexagon(l)
                    .with(TURN)
                    .rapid(12.0, 2.0)
                    .rapid(9.75, 2.0)
                    .feed(9.75, -9.0)
                    .rapid(12.0, 2.0)
            },
            &[],
        ),
        ("its corners finished", |l| hexagon(l).turned(TURN, 9.75, [2.0, -12.0]), &[]),
        ("turned behind it", |l| hexagon(l).turned(GROOVE, 8.0, [-14.0, -30.0]), &[]),
        ("a groove behind it", |l| hexagon(l).groove(GROOVE, -14.0, 6.0), &[]),
        ("parted off behind it", |l| hexagon(l).groove(GROOVE, -14.0, -0.2), &[]),
        (
            "parted off behind it, and what is left in the chuck turned",
            |l| hexagon(l).groove(GROOVE, -14.0, -0.2).line(3).turned(TURN, 8.0, [2.0, -25.0]),
            &[],
        ),
        ("a chamfer of half a millimetre", |l| hexagon(l).chamfer(0.5), &[]),
        ("faced by half a millimetre", |l| hexagon(l).faced(-0.5), &[]),
        ("a hole of 8 mm", |l| hexagon(l).drilled(DRILL_8, -30.0), &[]),
        ("turned over it in the air", |l| hexagon(l).turned(TURN, 9.95, [2.0, -12.0]), &[]),
        ("turned to 19.7 mm before", |l| hexagon(l.turned(TURN, 9.85, [2.0, -12.0])), &[]),
        ("faced by a millimetre before", |l| hexagon(l.faced(-1.0)), &[]),
        ("faced by three millimetres before", |l| hexagon(l.faced(-3.0)), &[]),
    ]);
}

#[test]
fn a_polygon_over_a_polygon_leaves_what_both_leave() {
    hold(&[
        (
            "turned by half a facet",
            |l| hexagon(l).hexagon([2.0, -10.0], 60.0),
            &[OF_THE_HEXAGON, "polygon of line 2: line 1 has cut its corners"],
        ),
        ("the same again", |l| hexagon(l).hexagon([2.0, -10.0], 0.0), &[]),
        ("beside it", |l| hexagon(l).hexagon([-12.0, -20.0], 60.0), &[]),
    ]);
}

#[test]
fn a_thread_and_a_polygon_in_one_place_are_neither_good() {
    hold(&[
        (
            "a thread over a polygon",
            |l| hexagon(l).m20(),
            &[
                OF_THE_HEXAGON,
                "turned thread of line 2: ",
                "cut over line 1: the facets of the hexagon 17.000 lie",
            ],
        ),
        (
            "a polygon over a thread",
            |l| l.line(1).m20().line(2).hexagon([2.0, -10.0], 0.0),
            &[
                "turned thread of line 1: good when cut, destroyed in line 2: the facets of the hexagon",
            ],
        ),
        (
            "a polygon over the end of a thread",
            |l| l.line(1).m20().line(2).hexagon([-20.0, -40.0], 0.0),
            &[
                "turned thread of line 1: good when cut, destroyed in line 2: the facets of the hexagon",
            ],
        ),
        // side by side
        ("a polygon behind a thread", |l| l.m20().line(2).hexagon([-30.0, -40.0], 0.0), &[]),
        (
            "a thread behind a polygon, in a groove's way",
            |l| {
                hexagon(l)
                    .groove(GROOVE, -14.0, 8.5)
                    .with(FULL)
                    .line(3)
                    .pass(9.6, [-11.5, -30.0], 1.5, 0.0)
                    .pass(9.25, [-11.5, -30.0], 1.5, 0.0)
                    .pass(9.015, [-11.5, -30.0], 1.5, 0.0)
            },
            &[],
        ),
        (
            "a thread on a bar that was turned down before its hexagon",
            |l| l.hexagon([-30.0, -40.0], 0.0).line(2).m20(),
            &[],
        ),
        (
            "a thread turned off and a polygon cut there",
            |l| {
                l.line(1)
                    .m20()
                    .line(2)
                    .turned(TURN, 8.8, [2.0, -27.0])
                    .line(3)
                    .hexagon([2.0, -10.0], 0.0)
            },
            &["turned thread of line 1: good when cut, destroyed in line 2"],
        ),
    ]);
}

#[test]
fn what_was_taken_before_is_told_when_it_is_destroyed() {
    let (lathe, features) = hexagon(Lathe::new()).counted();
    assert!(features.len() == 1 && features[0].verdict.is_pass(), "{features:?}");
    let undone = lathe.line(7).turned(TURN, 8.0, [2.0, -12.0]).undone();
    assert_eq!(undone, [(7, "nothing is left of its facets".to_owned())]);
    let (lathe, _) = hexagon(Lathe::new()).counted();
    let undone = lathe.line(7).hexagon([2.0, -10.0], 60.0).undone();
    assert_eq!(undone.len(), 1, "{undone:?}");
    assert!(undone[0].0 == 7 && undone[0].1.contains("was cut over it"), "{undone:?}");
    let (lathe, _) = hexagon(Lathe::new()).counted();
    assert!(lathe.line(7).turned(GROOVE, 8.0, [-14.0, -30.0]).undone().is_empty());
}

#[test]
fn cuts_that_are_each_too_shallow_to_count_are_summed() {
    let passes = |lathe: Lathe, from: f64, count: u32, end: f64| {
        let radii = (1..=count).map(|k| from - 0.004 * f64::from(k));
        radii.fold(lathe.with(TURN), |l, radius| {
            l.rapid(12.0, 2.0).rapid(radius, 2.0).rapid(radius, end).rapid(12.0, end)
        })
    };
    let facings = |lathe: Lathe, count: u32| {
        let places = (1..=count).map(|k| -0.004 * f64::from(k));
        places.fold(lathe.with(TURN), |l, z| l.rapid(11.0, z).rapid(-0.4, z).rapid(11.0, 2.0))
    };
    // the crests of M20x1.5 are at 9.93 mm, and 9.866 mm are allowed
    let thread =
        |count: u32| passes(Lathe::new().line(1).m20().line(2), 9.93, count, -27.0).wrong();
    assert_eq!(thread(10), [""; 0]);
    assert!(thread(30).concat().contains("good when cut, destroyed in line 2"), "{:?}", thread(30));
    // corners of the hexagon at 9.81 mm, of which 9.43 mm are left at least
    let corners = |count: u32| passes(hexagon(Lathe::new()), 9.82, count, -12.0).wrong();
    assert_eq!(corners(10), [""; 0]);
    assert!(corners(110).concat().contains(OF_THE_HEXAGON), "{:?}", corners(110));
    // a tenth of its height may be faced off
    assert_eq!(facings(hexagon(Lathe::new()), 50).wrong(), [""; 0]);
    assert!(facings(hexagon(Lathe::new()), 400).wrong().concat().contains(OF_THE_HEXAGON));
}

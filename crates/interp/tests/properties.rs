//! What must hold of every program: the way of writing does not change what is machined.
//!
//! A part is a list of moves in the plane's own axes. It is written out in several ways (inches,
//! increments, another plane, another offset), and each text must come to the same operations.
use canon::{Feed, Op, OpKind, Plane, Position};
use interp::{Limits, Ops, Setup};
use proptest::prelude::*;
use std::fmt::Write;
use test_support::size;
use units::{Angle, Length};

/// A move, in mm: first axis, second axis, normal.
#[derive(Clone, Debug)]
enum Move {
    Rapid([f64; 3]),
    Line([f64; 3], f64),
    /// A quarter turn counter-clockwise, to the right and up, of this radius.
    Quarter(f64),
    /// A cycle: code, place, height of R above the bottom, depth.
    Hole(u16, [f64; 2], f64, f64),
}

fn a_move() -> impl Strategy<Value = Move> {
    let at = || [-90.0..90.0, -90.0..90.0, -40.0..40.0f64];
    prop_oneof![
        at().prop_map(Move::Rapid),
        (at(), 1.0..5000.0).prop_map(|(to, feed)| Move::Line(to, feed)),
        (0.1..50.0).prop_map(Move::Quarter),
        (
            prop::sample::select(vec![730, 810, 820, 830, 840, 850, 860, 890]),
            [-90.0..90.0, -90.0..90.0f64],
            1.0..20.0,
            -40.0..10.0
        )
            .prop_map(|(code, at, stroke, bottom)| Move::Hole(code, at, stroke, bottom)),
    ]
}

fn a_part() -> impl Strategy<Value = Vec<Move>> {
    prop::collection::vec(a_move(), 1..12)
}

/// How a part is written.
#[derive(Clone, Copy)]
struct Hand {
    inch: bool,
    incremental: bool,
    plane: Plane,
    /// Added to every coordinate, and taken off again by the work offset.
    shift: [f64; 3],
}

const PLAIN: Hand = Hand { inch: false, incremental: false, plane: Plane::XY, shift: [0.0; 3] };

impl Hand {
    fn write(self, part: &[Move]) -> String {
        let unit = if self.inch { 25.4 } else { 1.0 };
        let axes = self.plane.axes().map(canon::Axis::letter);
        let centre = self.plane.axes().map(|a| ['I', 'J', 'K'][a.index()]);
        let plane = match self.plane {
            Plane::XY => 17,
            Plane::ZX => 18,
            Plane::YZ => 19,
        };
        let [u, v, w] = self.shift;
        let mut text = format!("{} G{plane} G98 S1000 M3\n", if self.inch { "G20" } else { "G21" });
        let origin = [(axes[0], -u), (axes[1], -v), (axes[2], -w)]
            .map(|(l, v)| format!("{l}{:.12}", v / unit));
        writeln!(text, "G10 L2 P1 {}", origin.join(" ")).unwrap();
        writeln!(text, "G0 {}0 {}0 {}0", axes[0], axes[1], axes[2]).unwrap();
        let mut at = [0.0; 3];
        if self.shift != [0.0; 3] {
            text = text.replace("G0 X0 Y0 Z0", &format!("G0 X{u:.12} Y{v:.12} Z{w:.12}"));
            at = self.shift;
        }
        writeln!(text, "{}", if self.incremental { "G91" } else { "G90" }).unwrap();
        for step in part {
            let word = |i: usize, to: f64, from: f64| {
                let value = if self.incremental { to - from } else { to };
                format!("{}{:.12}", axes[i], value / unit)
            };
            let words =
                |to: [f64; 3]| -> String { (0..3).map(|i| word(i, to[i], at[i]) + " ").collect() };
            let shifted = |p: [f64; 3]| [p[0] + u, p[1] + v, p[2] + w];
            match *step {
                Move::Rapid(to) => {
                    let to = shifted(to);
                    writeln!(text, "G0 {}", words(to)).unwrap();
                    at = to;
                }
                Move::Line(to, feed) => {
                    let to = shifted(to);
                    writeln!(text, "G1 {}F{:.12}", words(to), feed / unit).unwrap();
                    at = to;
                }
                Move::Quarter(radius) => {
                    let to = [at[0] + radius, at[1] + radius, at[2]];
                    let words = words(to);
                    writeln!(
                        text,
                        "F{:.12} G3 {words} {}0 {}{:.12}",
                        300.0 / unit,
                        centre[0],
                        centre[1],
                        radius / unit
                    )
                    .unwrap();
                    at = to;
                }
                Move::Hole(code, to, stroke, bottom) => {
                    let to = shifted([to[0], to[1], bottom]);
                    let r = to[2] + stroke;
                    let (r_word, z_word) =
                        if self.incremental { (r - at[2], to[2] - r) } else { (r, to[2]) };
                    let more = match code {
                        730 | 830 => format!("Q{:.12}", 3.0 / unit),
                        820 | 840 | 860 | 890 => "P0.5".to_owned(),
                        _ => String::new(),
                    };
                    writeln!(
                        text,
                        "F{:.12} G{} {} {} {}{:.12} R{:.12} {more}\nG80",
                        800.0 / unit,
                        code / 10,
                        word(0, to[0], at[0]),
                        word(1, to[1], at[1]),
                        axes[2],
                        z_word / unit,
                        r_word / unit,
                    )
                    .unwrap();
                    at = [to[0], to[1], at[2].max(r)];
                }
            }
        }
        text + "M2\n"
    }
}

/// An operation as its name and its numbers, the axes turned into the plane's own order.
fn essence(op: &Op, plane: Plane) -> (String, Vec<f64>) {
    let axes = plane.axes();
    let place = |p: &Position| -> Vec<f64> { axes.iter().map(|a| p.along(*a).value()).collect() };
    let speed = |feed: &Feed| match feed {
        Feed::PerTime(speed) => speed.value(),
        Feed::PerRevolution(lead) => lead.value(),
        Feed::Duration(time) => time.value(),
    };
    let (name, numbers): (&str, Vec<f64>) = match &op.kind {
        OpKind::Rapid { to } => ("rapid", place(to)),
        OpKind::Line { to, feed } => ("line", [place(to), vec![speed(feed)]].concat()),
        OpKind::Arc { to, arc, feed } => {
            let own =
                [arc.centre[0].value(), arc.centre[1].value(), arc.sweep.value(), speed(feed)];
            ("arc", [place(to), own.to_vec()].concat())
        }
        OpKind::Hole(hole) => ("hole", [place(&hole.at), vec![hole.bottom.value()]].concat()),
        OpKind::Tap(tap) => {
            let own = [tap.bottom.value(), tap.lead.value(), tap.spin.value(), tap.dwell.value()];
            ("tap", [place(&tap.start), own.to_vec()].concat())
        }
        OpKind::Dwell { time } => ("dwell", vec![time.value()]),
        other => return (format!("{other:?}"), Vec::new()),
    };
    (name.to_owned(), numbers)
}

fn essences(hand: Hand, part: &[Move]) -> Vec<(String, Vec<f64>)> {
    let text = hand.write(part);
    let setup = Setup::default();
    let mut ops = Ops::new(text.as_bytes(), &setup);
    let all: Vec<_> = ops.by_ref().map(|op| essence(&op, hand.plane)).collect();
    assert!(!ops.has_errors(), "{:?}\n{text}", ops.diagnostics());
    all
}

fn same(a: &[(String, Vec<f64>)], b: &[(String, Vec<f64>)]) -> Result<(), TestCaseError> {
    prop_assert_eq!(a.len(), b.len(), "{:?}\n{:?}", a, b);
    for ((name, x), (other, y)) in a.iter().zip(b) {
        prop_assert_eq!(name, other);
        for (x, y) in x.iter().zip(y) {
            prop_assert!((x - y).abs() < 1e-7, "{}: {} is not {}", name, x, y);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(64, 1280)))]

    #[test]
    fn inches_and_millimetres_make_the_same_part(part in a_part()) {
        // A peck's clearance is 0.010 inch in both units.
        same(&essences(PLAIN, &part), &essences(Hand { inch: true, ..PLAIN }, &part))?;
    }

    #[test]
    fn increments_and_coordinates_make_the_same_part(part in a_part()) {
        same(&essences(PLAIN, &part), &essences(Hand { incremental: true, ..PLAIN }, &part))?;
    }

    #[test]
    fn the_three_planes_make_the_same_part_turned(part in a_part()) {
        for plane in [Plane::ZX, Plane::YZ] {
            same(&essences(PLAIN, &part), &essences(Hand { plane, ..PLAIN }, &part))?;
        }
    }

    #[test]
    fn a_work_offset_takes_off_what_the_coordinates_have_too_much(part in a_part(), shift in [-50.0..50.0, -50.0..50.0, -50.0..50.0f64]) {
        let mut shifted = essences(Hand { shift, ..PLAIN }, &part);
        let mut plain = essences(PLAIN, &part);
        // The moves to the first place differ in what they leave out.
        let first = |all: &[(String, Vec<f64>)]| all.iter().position(|(n, _)| n == "line" || n == "arc" || n == "hole").unwrap_or(all.len());
        shifted.drain(..first(&shifted));
        plain.drain(..first(&plain));
        same(&plain, &shifted)?;
    }

    #[test]
    fn a_rotation_keeps_distances(part in a_part(), degrees in -180.0..180.0f64) {
        let plain: Vec<_> = essences(PLAIN, &part);
        let text = PLAIN.write(&part).replace("G10 L2 P1", &format!("G10 L2 P1 R{degrees}"));
        let setup = Setup::default();
        let turned: Vec<_> = Ops::new(text.as_bytes(), &setup).map(|op| essence(&op, Plane::XY)).collect();
        let (sin, cos) = degrees.to_radians().sin_cos();
        prop_assert_eq!(plain.len(), turned.len());
        for ((_, p), (_, t)) in plain.iter().zip(&turned).filter(|((_, p), _)| p.len() > 1) {
            prop_assert!((p[0] * cos - p[1] * sin - t[0]).abs() < 1e-9);
            prop_assert!((p[0] * sin + p[1] * cos - t[1]).abs() < 1e-9);
            prop_assert!((p[2] - t[2]).abs() < 1e-9);
        }
    }

    #[test]
    fn two_runs_are_the_same_to_the_bit(part in a_part()) {
        let text = PLAIN.write(&part);
        let setup = Setup::default();
        let run = || Ops::new(text.as_bytes(), &setup).collect::<Vec<_>>();
        prop_assert_eq!(run(), run());
    }
}

/// Short limits, so that loops made of noise end soon.
fn impatient() -> Setup {
    Setup { limits: Limits { blocks: 2_000, ..Limits::default() }, ..Setup::default() }
}

/// Pieces from which nearly correct programs come, parted by bars.
const PIECES: &str = "\
    G0|G1|G2|G3|G33.1|G76|G81|G83|G84|G74|G73|G86|G91|G90|G20|G21|G18|G19|G10 L2 P1|\
    G10 L20 P0|G92|G92.1|G53|G28|G28.1|G43.1|G49|G54|G59.3|G93|G94|G95|G7|G96 S100|G98|G90.1|\
    M3|M4|M5|M6|M2|M98 P1|M99|T0|S1000|F100|X1|Y-2.5|Z3|R1|R0|Q0.5|P1|I1|J0|K0.5|L2|L0|E1|H1|\
    A9|@5|^30|X1e9|#1=[#1+1]|X#1|Z[1/#2]|o1 sub|o1 endsub|o1 call|o2 if [#1 LT 3]|o2 else|\
    o2 endif|o3 while [#1 LT 9]|o3 endwhile|o4 repeat [3]|o4 break|o4 continue|o4 endrepeat|\
    o5 do|o5 while [0]|O1|(MSG,#1)|(DEBUG,#<_x> %d)|%|\n|\n|\n|\n|\n";

fn soup() -> impl Strategy<Value = String> {
    let pieces: Vec<&str> = PIECES.split('|').collect();
    prop::collection::vec(prop::sample::select(pieces), 0..80)
        .prop_map(|pieces| pieces.join(" ").replace(" \n ", "\n"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(400, 4000)))]

    #[test]
    fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        _ = interp::check(&bytes, &impatient());
    }

    #[test]
    fn no_soup_of_words_makes_it_panic_and_what_comes_out_is_finite(text in soup()) {
        let setup = impatient();
        for op in Ops::new(text.as_bytes(), &setup) {
            if let OpKind::Rapid { to } | OpKind::Line { to, .. } | OpKind::Arc { to, .. } = op.kind {
                prop_assert!(to.linear.iter().chain(&to.parallel).all(|l: &Length| l.is_finite()));
                prop_assert!(to.rotary.iter().all(|a: &Angle| a.is_finite()));
            }
        }
        let mut listing = interp::Listing::new(std::io::sink());
        interp::Interpreter::new(text.as_bytes(), &setup).run(&mut listing);
        prop_assert!(listing.finish().is_ok());
    }
}

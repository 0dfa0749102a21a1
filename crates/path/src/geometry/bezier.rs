//! Bézier curves of the fifth degree, cut into parts that can be run through evenly: each has a
//! parameter by its length of its own ([`motion::Bezier`]), so that |q′| is 1 to within a percent
//! or so.
use alloc::vec::Vec;
use motion::{Bezier, Point, Shape as _};

/// How often a curve may be halved to make its parts even.
const HALVINGS: u32 = 18;

/// A curve of the third degree, in parts.
pub fn cubic(control: [Point; 4], parts: &mut Vec<Bezier>) {
    let [p, q, r, s] = control;
    let mix = |terms: &[(&Point, f64)]| -> Point {
        core::array::from_fn(|i| terms.iter().map(|(p, w)| p[i] * w / 10.0).sum())
    };
    let raised = [
        p,
        mix(&[(&p, 4.0), (&q, 6.0)]),
        mix(&[(&p, 1.0), (&q, 6.0), (&r, 3.0)]),
        mix(&[(&q, 3.0), (&r, 6.0), (&s, 1.0)]),
        mix(&[(&r, 6.0), (&s, 4.0)]),
        s,
    ];
    quintic(raised, parts);
}

/// A curve of the fifth degree, in parts; more of them where it bends sharply.
pub fn quintic(control: [Point; 6], parts: &mut Vec<Bezier>) {
    cut(&control, HALVINGS, parts);
}

fn cut(control: &[Point; 6], depth: u32, parts: &mut Vec<Bezier>) {
    let whole = Bezier::new(*control);
    if whole.is_even(0.01) || depth == 0 {
        if whole.length() > 0.0 {
            parts.push(whole);
        }
        return;
    }
    let (left, right) = halves(control);
    cut(&left, depth - 1, parts);
    cut(&right, depth - 1, parts);
}

fn halves(control: &[Point; 6]) -> ([Point; 6], [Point; 6]) {
    let (mut row, mut left, mut right) = (*control, *control, *control);
    for level in 0..6 {
        left[level] = row[0];
        right[5 - level] = row[5 - level];
        for j in 0..5 - level {
            row[j] = core::array::from_fn(|i| f64::midpoint(row[j][i], row[j + 1][i]));
        }
    }
    (left, right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use motion::AXES;
    use proptest::prelude::*;

    proptest! {
        /// However short the parts are: a rounding over the third power of a part's length is no
        /// jerk.
        #[test]
        fn an_axis_that_rests_rests_to_the_last_bit(
            rest in -1000.0..1000.0_f64,
            bulge in prop::array::uniform6(prop::array::uniform2(-1.0..1.0_f64)),
            place in 0.0..1.0_f64,
        ) {
            let point = |k: usize| {
                let mut point = [rest; AXES];
                [point[0], point[1]] = [k as f64 / 5.0 + bulge[k][0], bulge[k][1]];
                point
            };
            let mut parts = Vec::new();
            quintic(core::array::from_fn(point), &mut parts);
            for part in parts {
                let d = part.at(place * part.length());
                for axis in 2..AXES {
                    let still = [d.q[axis], d.q1[axis], d.q2[axis], d.q3[axis]];
                    prop_assert_eq!(still, [rest, 0.0, 0.0, 0.0]);
                }
            }
        }
    }
}

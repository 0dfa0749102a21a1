//! A function of one turn of the master, given by its values at equidistant angles.
//!
//! ```text
//!    x │      ●──●                      x(θ) = Σ c_k·β(N·θ − k)     β: quintic B-spline
//!      │    ╱      ╲                    through every node, periodic, and smooth up to the
//!      │  ●          ●                  fourth derivative, across the seam as everywhere
//!      │╱              ╲●
//!   ───●─────────────────●──► θ         N nodes a turn; node 0 stands at θ = 0
//!      0        1/2       1 rev
//! ```
//!
//! Of a tone of k waves a turn the spline misses about (2πk/N)⁶/30 000 of its amplitude between the
//! nodes.
//!
//! The coefficients c follow from the values x by two recursive filters, one each way (M. Unser:
//! Splines, a perfect fit for signal and image processing, IEEE Signal Processing Magazine 16(6),
//! 1999, box 2), started with the sum over the turn that periodicity demands. That costs O(N) and
//! is done outside the servo's tick; a value and its derivatives cost some fifty products, whatever
//! N is.
use alloc::vec::Vec;

/// The two poles of the quintic's filter.
const POLES: [f64; 2] = [-0.430_575_347_099_973_8, -0.043_096_288_203_264_65];
/// Fewer nodes than this are no table.
pub const FEWEST_NODES: usize = 8;
/// More than this are refused: a node each 20 seconds of arc.
pub const MOST_NODES: usize = 65_536;

/// A function and its derivatives at one angle; the unit is that of the table, per revolution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PeriodicPoint {
    /// Value.
    pub value: f64,
    /// First derivative, per rev.
    pub slope: f64,
    /// Second derivative, per rev².
    pub bend: f64,
    /// Third derivative, per rev³.
    pub jolt: f64,
}

/// Why a table is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PeriodicError {
    /// Fewer than [`FEWEST_NODES`] or more than [`MOST_NODES`].
    Nodes {
        /// How many there are.
        count: usize,
    },
    /// A value is infinite or not a number.
    NotFinite {
        /// Which node, counted from 0.
        node: usize,
    },
}

impl core::fmt::Display for PeriodicError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Nodes { count } => {
                write!(f, "expected {FEWEST_NODES} to {MOST_NODES} nodes a turn, found {count}")
            }
            Self::NotFinite { node } => {
                write!(f, "the value of node {node} is not a finite number")
            }
        }
    }
}

impl core::error::Error for PeriodicError {}

/// A periodic quintic spline over one turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Periodic {
    /// Coefficients from −2 to N + 2, so that no index wraps.
    coefficients: Vec<f64>,
    nodes: usize,
}

impl Periodic {
    /// Through these values, which stand at θ = k/N.
    ///
    /// # Errors
    /// See [`PeriodicError`].
    pub fn new(values: &[f64]) -> Result<Self, PeriodicError> {
        let count = values.len();
        if !(FEWEST_NODES..=MOST_NODES).contains(&count) {
            return Err(PeriodicError::Nodes { count });
        }
        if let Some(node) = values.iter().position(|v| !v.is_finite()) {
            return Err(PeriodicError::NotFinite { node });
        }
        let mut inner = values.to_vec();
        for z in POLES {
            filter(&mut inner, z);
        }
        let wrapped = (0..count + 5).map(|i| inner[(i + count - 2) % count]);
        Ok(Self { coefficients: wrapped.collect(), nodes: count })
    }

    /// Nodes a turn.
    #[allow(clippy::len_without_is_empty)] // it never is: FEWEST_NODES
    pub const fn len(&self) -> usize {
        self.nodes
    }

    /// Value and derivatives at an angle in revolutions, unwrapped: whole turns do not matter.
    pub fn at(&self, turn: f64) -> PeriodicPoint {
        let n = self.nodes as f64;
        let place = (turn - libm::floor(turn)) * n;
        // the product may round up to N itself; there the fraction is 1 and the spline goes on
        // smoothly
        let whole = (place as usize).min(self.nodes - 1);
        let f = place - whole as f64;
        let Some(&[a, b, c, d, e, g]) = self.coefficients.get(whole..whole + 6) else {
            return PeriodicPoint::default(); // not reached: `whole` is below N
        };
        let [p0, p1, p2, p3, p4, p5] = polynomial([a, b, c, d, e, g]);
        PeriodicPoint {
            value: p0 + f * (p1 + f * (p2 + f * (p3 + f * (p4 + f * p5)))),
            slope: n * (p1 + f * (2.0 * p2 + f * (3.0 * p3 + f * (4.0 * p4 + f * 5.0 * p5)))),
            bend: n * n * (2.0 * p2 + f * (6.0 * p3 + f * (12.0 * p4 + f * 20.0 * p5))),
            jolt: n * n * n * (6.0 * p3 + f * (24.0 * p4 + f * 60.0 * p5)),
        }
    }
}

/// x ← x filtered by λ·z-pole both ways, periodic.
fn filter(x: &mut [f64], z: f64) {
    let n = x.len();
    let gain = (1.0 - z) * (1.0 - 1.0 / z);
    // z^n is below 1e-3 at the fewest nodes: the sums over one turn, closed by 1/(1 − z^n), are
    // exact
    let closing = 1.0 / (1.0 - libm::pow(z, n as f64));
    let (mut before, mut power) = (0.0, closing);
    for k in 0..n {
        before += power * x[(n - k) % n];
        power *= z;
        if power.abs() < 1e-20 {
            break;
        }
    }
    x[0] = before;
    for k in 1..n {
        x[k] += z * x[k - 1];
    }
    let (mut last, mut power) = (0.0, -z * closing);
    for k in 0..n {
        last += power * x[(n - 1 + k) % n];
        power *= z;
        if power.abs() < 1e-20 {
            break;
        }
    }
    x[n - 1] = last;
    for k in (0..n - 1).rev() {
        x[k] = z * (x[k + 1] - x[k]);
    }
    for v in x.iter_mut() {
        *v *= gain;
    }
}

/// The polynomial between two nodes, by powers of the fraction of the way, from the coefficients
/// c₋₂ … c₃ around.
fn polynomial(c: [f64; 6]) -> [f64; 6] {
    let [a, b, c, d, e, f] = c;
    [
        (a + 26.0 * b + 66.0 * c + 26.0 * d + e) / 120.0,
        (e - a + 10.0 * (d - b)) / 24.0,
        (a + 2.0 * b - 6.0 * c + 2.0 * d + e) / 12.0,
        (e - a + 2.0 * (b - d)) / 12.0,
        (a - 4.0 * b + 6.0 * c - 4.0 * d + e) / 24.0,
        (f - a + 5.0 * (b - e) + 10.0 * (d - c)) / 120.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;
    use proptest::prelude::*;
    use std::vec;

    fn tone(nodes: usize, waves: f64, phase: f64) -> Periodic {
        let values: Vec<f64> =
            (0..nodes).map(|k| f64::sin(TAU * (waves * k as f64 / nodes as f64 + phase))).collect();
        Periodic::new(&values).unwrap()
    }

    #[test]
    fn the_poles_are_those_of_the_quintic() {
        // roots of z⁴ + 26 z³ + 66 z² + 26 z + 1, the samples of 120·β
        for z in POLES {
            let p = 1.0 + z * (26.0 + z * (66.0 + z * (26.0 + z)));
            assert!(p.abs() < 1e-13, "{p}");
        }
    }

    #[test]
    fn what_is_no_table_is_refused_with_the_node() {
        assert_eq!(Periodic::new(&[0.0; 7]), Err(PeriodicError::Nodes { count: 7 }));
        assert_eq!(
            Periodic::new(&vec![0.0; MOST_NODES + 1]),
            Err(PeriodicError::Nodes { count: MOST_NODES + 1 })
        );
        let mut values = [0.0; 12];
        values[5] = f64::NAN;
        assert_eq!(Periodic::new(&values), Err(PeriodicError::NotFinite { node: 5 }));
    }

    #[test]
    fn an_angle_that_is_no_number_gives_no_panic() {
        let p = tone(720, 3.0, 0.0);
        for turn in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, -1e-300, -0.0] {
            let _ = p.at(turn);
        }
    }

    proptest! {
        #[test]
        fn it_goes_through_its_nodes(values in prop::collection::vec(-100.0..100.0f64, 8..200)) {
            let p = Periodic::new(&values).unwrap();
            for (k, v) in values.iter().enumerate() {
                let at = p.at(k as f64 / values.len() as f64 - 3.0).value;
                prop_assert!((at - v).abs() < 1e-9, "node {k}: {at} instead of {v}");
            }
        }

        #[test]
        fn a_sine_and_its_derivatives_are_met_between_the_nodes(
            waves in 1u32..20, phase in 0.0..1.0f64, turn in -50.0..50.0f64, nodes in 360usize..1440,
        ) {
            let waves = f64::from(waves);
            let (p, w) = (tone(nodes, waves, phase).at(turn), TAU * waves);
            let (sin, cos) = (w * turn + TAU * phase).sin_cos();
            // error of a quintic: h⁶·w⁶/30 000, and one power of h less with each derivative
            let x = w / nodes as f64;
            let bound = |order: i32| w.powi(order) * (x.powi(6 - order) + 1e-10 * x.powi(-order));
            prop_assert!((p.value - sin).abs() < bound(0) / 10_000.0 + 1e-11);
            prop_assert!((p.slope - w * cos).abs() < bound(1) / 100.0);
            prop_assert!((p.bend + w * w * sin).abs() < bound(2) / 100.0);
            prop_assert!((p.jolt + w * w * w * cos).abs() < bound(3) / 10.0);
        }

        #[test]
        fn whole_turns_do_not_matter(turn in 0.0..1.0f64, turns in -1000i32..1000) {
            let p = tone(720, 5.0, 0.3);
            prop_assert!((p.at(turn).value - p.at(turn + f64::from(turns)).value).abs() < 1e-10);
        }

        #[test]
        fn nothing_jumps_at_a_node_or_at_the_seam(
            values in prop::collection::vec(-1.0..1.0f64, 8..60), node in 0usize..60,
        ) {
            let n = values.len();
            let p = Periodic::new(&values).unwrap();
            let (at, e) = ((node % n) as f64 / n as f64, 1e-9);
            let (before, after) = (p.at(at - e), p.at(at + e));
            let scale = n as f64;
            prop_assert!((before.value - after.value).abs() < 1e-6 * scale);
            prop_assert!((before.slope - after.slope).abs() < 1e-6 * scale.powi(2));
            prop_assert!((before.bend - after.bend).abs() < 1e-6 * scale.powi(3));
            prop_assert!((before.jolt - after.jolt).abs() < 1e-6 * scale.powi(4));
        }
    }
}

//! Tables of what is superposed on an axis by a spindle's turn: over one turn of the master, or
//! over the few after which a gear begins anew. What feeds the kernel hands it the tables before
//! the steps that name them ([`motion::Superpose`]).
use alloc::vec::Vec;
use canon::Harmonic;
use core::f64::consts::TAU;
use motion::TableId;

/// Nodes of a table that is made from harmonics: a cubic through 720 of them errs by 4·10⁻⁹ of the
/// amplitude of the fourth harmonic.
const NODES: usize = 720;
/// Nodes for each period of the highest harmonic, at least.
const NODES_PER_PERIOD: usize = 90;
/// Most nodes of a table.
const MOST_NODES: usize = 7200;

/// The number by which a step asks what runs the kernel to look at how a polygon's oscillation
/// came out.
pub const OSCILLATION_SEEN: u16 = 514;

/// A function of one turn of a master, or of a few, at equal steps from 0: mm on an axis, rev on a
/// spindle.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Its name.
    pub id: TableId,
    /// Its values.
    pub nodes: Vec<f64>,
}

/// A sum of harmonics at equal steps of a turn.
pub fn sampled(harmonics: &[Harmonic]) -> Vec<f64> {
    let circle = circle(harmonics);
    let count = circle.len();
    let at = |node: usize| {
        let of = |h: &Harmonic| {
            let [cosine, sine] = circle[(h.per_turn as usize * node) % count];
            h.cosine * cosine + h.sine * sine
        };
        harmonics.iter().map(of).sum()
    };
    (0..count).map(at).collect()
}

/// Largest speed, acceleration and jerk of a sum of harmonics whose argument turns once a second,
/// mm and s.
pub(crate) fn rates(harmonics: &[Harmonic]) -> [f64; 3] {
    let circle = circle(harmonics);
    let count = circle.len();
    let mut most = [0.0_f64; 3];
    for node in 0..count {
        let mut now = [0.0; 3];
        for h in harmonics {
            let [cosine, sine] = circle[(h.per_turn as usize * node) % count];
            let w = TAU * f64::from(h.per_turn);
            let (value, quarter) =
                (h.cosine * cosine + h.sine * sine, h.sine * cosine - h.cosine * sine);
            now[0] += w * quarter;
            now[1] -= w * w * value;
            now[2] -= w * w * w * quarter;
        }
        for (most, now) in most.iter_mut().zip(now) {
            *most = most.max(now.abs());
        }
    }
    most
}

/// Cosine and sine at every node of a table that these harmonics need.
fn circle(harmonics: &[Harmonic]) -> Vec<[f64; 2]> {
    let highest = harmonics.iter().map(|h| h.per_turn as usize).max().unwrap_or(0);
    let count = NODES.max(highest.saturating_mul(NODES_PER_PERIOD)).min(MOST_NODES);
    let at = |node: usize| {
        let angle = TAU * node as f64 / count as f64;
        [libm::cos(angle), libm::sin(angle)]
    };
    (0..count).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_of_a_cosine_has_its_amplitude_at_zero_and_its_opposite_half_a_period_later() {
        let nodes = sampled(&[Harmonic { per_turn: 4, cosine: 0.3, sine: 0.0 }]);
        assert_eq!(nodes[0], 0.3);
        assert!((nodes[nodes.len() / 8] + 0.3).abs() < 1e-12);
    }

    #[test]
    fn rates_are_those_of_the_derivatives() {
        let one = rates(&[Harmonic { per_turn: 4, cosine: 0.0, sine: 0.5 }]);
        for (power, found) in (1..4).zip(one) {
            assert!((found / (0.5 * (4.0 * TAU).powi(power)) - 1.0).abs() < 1e-3, "{one:?}");
        }
    }

    #[test]
    fn higher_harmonics_get_more_nodes_up_to_the_bound() {
        let of = |per_turn| {
            let harmonic = Harmonic { per_turn, cosine: 1.0, sine: 0.0 };
            sampled(&[harmonic]).len()
        };
        assert_eq!((of(4), of(24), of(4000)), (720, 2160, 7200));
    }
}

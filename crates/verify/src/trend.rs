//! Wear of a tap over a program, as its torque tells it.
//!
//! ```text
//!   M │            · ·  ╱·          M = M₀·(1 + w·x) + f·(h − h̄)    least squares over the threads of one tap
//!     │   ·  · ╱·╱· ·               w with its standard error: threads differ by chance, too
//!     │ · ╱·  ·
//!     └───────────────────► x       length of thread that the tap has cut
//! ```
//!
//! A tap gets duller with the length of thread that it has cut, and needs more torque. Whether a
//! rise is wear or chance is a question of how much the threads scatter: the trend says both, and
//! calls it wear only when the rise is more than chance makes of it once in twenty times (Student's
//! t: with few threads that is far more than two standard errors).
//!
//! A deeper thread takes more torque, too: its flanks rub along more of it. Where depths h differ,
//! f takes that out of w: both M and x are first freed of what goes with h (Frisch and Waugh,
//! Econometrica 1, 1933).
use crate::feature::{Feature, FeatureKind};
use crate::tapped::Thread;
use units::{Length, Torque};

/// A slope of so many standard errors is believed, by degrees of freedom from 1 on: Student's t,
/// two-sided 95 %.
const BELIEVED: [f64; 12] =
    [12.71, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179];
/// The same with more of them.
const BELIEVED_OF_MANY: f64 = 2.1;
/// With fewer threads of a tap nothing is said of a trend.
const FEWEST: usize = 5;
/// Threads whose depths differ by less are equally deep, mm.
const SAME_DEPTH_MM: f64 = 0.05;

/// What the threads of one tap say.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueTrend {
    /// The tap.
    pub tool: u32,
    /// Size of its threads.
    pub size: String,
    /// By thread, in the order cut: thread that it had cut before and with it, torque in, torque
    /// out.
    pub threads: Vec<(Length, Torque, Option<Torque>)>,
    /// What the tap makers' formula expects on the way in.
    pub expected: Option<Torque>,
    /// M₀: torque of the tap before its first thread, by the fit.
    pub at_start: Torque,
    /// w: rise by metre of thread, as a share of M₀; `None` with too few threads for a fit.
    pub rise_per_m: Option<f64>,
    /// Standard error of w.
    pub uncertainty_per_m: f64,
    /// Threads beyond those that the fit needs: its degrees of freedom.
    pub spare: usize,
}

impl TorqueTrend {
    /// The trends of all taps that cut a thread whose torque is known, by their numbers.
    pub fn of(features: &[Feature]) -> Vec<Self> {
        let mut trends: Vec<Self> = Vec::new();
        for feature in features {
            if let (FeatureKind::Thread(thread), Some(tool)) = (&feature.kind, feature.tool)
                && let Some(torque) = thread.torque_in
            {
                let same = |t: &&mut Self| t.tool == tool && t.size == thread.size;
                if let Some(trend) = trends.iter_mut().find(same) {
                    trend.take(thread, torque);
                } else {
                    let mut trend = Self::begin(tool, thread);
                    trend.take(thread, torque);
                    trends.push(trend);
                }
            }
        }
        trends.sort_by_key(|trend| trend.tool);
        for trend in &mut trends {
            trend.fit();
        }
        trends
    }

    /// Whether the torque rises, and not by chance.
    pub fn is_wear(&self) -> bool {
        self.significant().is_some_and(|rise| rise > 0.0)
    }

    /// The rise by metre as far as the threads carry one: more than chance makes of it, either way,
    /// and from threads enough that a trend is a question at all.
    pub fn significant(&self) -> Option<f64> {
        let rise = self.rise_per_m.filter(|_| self.threads.len() >= FEWEST)?;
        (rise.abs() > self.believed() * self.uncertainty_per_m).then_some(rise)
    }

    fn believed(&self) -> f64 {
        let believed = BELIEVED.get(self.spare.saturating_sub(1)).copied();
        believed.unwrap_or(BELIEVED_OF_MANY)
    }

    /// The fitted line at so much thread cut.
    pub fn fitted(&self, cut: Length) -> Torque {
        self.at_start * (1.0 + self.rise_per_m.unwrap_or(0.0) * cut.value() * 1e-3)
    }

    fn begin(tool: u32, thread: &Thread) -> Self {
        Self {
            tool,
            size: thread.size.clone(),
            threads: Vec::new(),
            expected: thread.torque_expected,
            at_start: Torque::ZERO,
            rise_per_m: None,
            uncertainty_per_m: 0.0,
            spare: 0,
        }
    }

    fn take(&mut self, thread: &Thread, torque: Torque) {
        let before = self.threads.last().map_or(Length::ZERO, |(cut, ..)| *cut);
        self.threads.push((before + thread.tip_depth, torque, thread.torque_out));
    }

    fn fit(&mut self) {
        let cut: Vec<f64> = self.threads.iter().map(|(cut, ..)| cut.value() * 1e-3).collect();
        let torques: Vec<f64> = self.threads.iter().map(|(_, m, _)| m.value()).collect();
        let before = std::iter::once(0.0).chain(cut.iter().copied());
        let depths: Vec<f64> = cut.iter().zip(before).map(|(to, from)| (to - from) * 1e3).collect();
        let (x, y) = (mean(&cut), mean(&torques));
        self.at_start = Torque::n_m(y);
        let deep = centred(&depths);
        let equal = deep.iter().all(|h| h.abs() < SAME_DEPTH_MM / 2.0);
        let (dx, dy) = if equal {
            (centred(&cut), centred(&torques))
        } else {
            (freed(&centred(&cut), &deep), freed(&centred(&torques), &deep))
        };
        let spread = product(&dx, &dx);
        let spare = self.threads.len().saturating_sub(if equal { 2 } else { 3 });
        if spare == 0 || spread <= f64::EPSILON * product(&cut, &cut) {
            return;
        }
        let slope = product(&dx, &dy) / spread;
        let left: f64 = dx.iter().zip(&dy).map(|(x, y)| (y - slope * x).powi(2)).sum();
        let start = y - slope * x;
        if start <= 0.0 {
            return;
        }
        self.at_start = Torque::n_m(start);
        self.rise_per_m = Some(slope / start);
        self.uncertainty_per_m = (left / spare as f64 / spread).sqrt() / start;
        self.spare = spare;
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn centred(values: &[f64]) -> Vec<f64> {
    let middle = mean(values);
    values.iter().map(|value| value - middle).collect()
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What of `values` does not go with `other`; both have a mean of zero.
fn freed(values: &[f64], other: &[f64]) -> Vec<f64> {
    let share = product(values, other) / product(other, other);
    values.iter().zip(other).map(|(value, other)| value - share * other).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tap that cuts 20 mm deep threads, with these torques.
    fn trend(torques: &[f64]) -> TorqueTrend {
        trend_of(torques.iter().map(|m| (20.0, *m)))
    }

    /// The same with depths, mm.
    fn trend_of(threads: impl Iterator<Item = (f64, f64)>) -> TorqueTrend {
        let mut cut = Length::ZERO;
        let threads = threads.map(|(depth_mm, m)| {
            cut += Length::mm(depth_mm);
            (cut, Torque::n_m(m), None)
        });
        let mut trend = TorqueTrend {
            tool: 3,
            size: "M6x1".into(),
            threads: threads.collect(),
            expected: None,
            at_start: Torque::ZERO,
            rise_per_m: None,
            uncertainty_per_m: 0.0,
            spare: 0,
        };
        trend.fit();
        trend
    }

    #[test]
    fn a_torque_that_rises_with_the_thread_cut_is_wear() {
        // 2 N·m, and 10 % more by metre: 0.004 N·m a thread
        let torques: Vec<f64> = (1..=20).map(|k| 2.0 + 0.2 * 0.02 * f64::from(k)).collect();
        let seen = trend(&torques);
        assert!((seen.rise_per_m.unwrap() - 0.10).abs() < 1e-9, "{seen:?}");
        assert!(seen.is_wear() && (seen.fitted(Length::mm(1000.0)).value() - 2.2).abs() < 1e-9);
    }

    #[test]
    fn chance_is_not_wear() {
        let seen = trend(&[2.0, 2.1, 1.95, 2.05, 1.98, 2.06]);
        assert!(seen.rise_per_m.is_some() && !seen.is_wear(), "{seen:?}");
        assert_eq!(trend(&[2.0, 2.1]).rise_per_m, None);
    }

    #[test]
    fn threads_that_get_deeper_are_no_wear_and_hide_none() {
        let depths = [10.0, 20.0, 25.0, 12.0, 24.0, 15.0, 22.0, 11.0];
        // 5 % of 2 N·m for each diameter of depth, M6; a thousandth of chance
        let chance = [1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0];
        let rubbed = |k: usize| 2.0 * (1.0 + 0.05 * depths[k] / 6.0) + 0.002 * chance[k];
        let seen = trend_of((0..8).map(|k| (depths[k], rubbed(k))));
        assert!(!seen.is_wear() && seen.rise_per_m.unwrap().abs() < 0.05, "{seen:?}");
        let mut cut = 0.0;
        let worn = (0..8).map(|k| {
            cut += depths[k] * 1e-3;
            (depths[k], rubbed(k) + 2.0 * cut) // 2 N·m more by metre
        });
        let seen = trend_of(worn);
        assert!(seen.is_wear(), "{seen:?}");
        assert!((seen.rise_per_m.unwrap() * seen.at_start.value() - 2.0).abs() < 0.1, "{seen:?}");
    }

    #[test]
    fn three_threads_that_scatter_prove_nothing() {
        let seen = trend(&[2.0, 2.09, 2.2]);
        assert!(seen.rise_per_m.unwrap() > 2.0 * seen.uncertainty_per_m && seen.spare == 1);
        assert!(!trend(&[2.0, 2.15, 2.2]).is_wear());
        // exactly on a line, and yet only three
        assert_eq!(trend(&[2.0, 1.9, 1.8]).significant(), None);
    }
}

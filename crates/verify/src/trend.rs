//! Wear of a tap over a program, as its torque tells it.
//!
//! ```text
//!   M │            · ·  ╱·          M = M₀·(1 + w·x)      least squares over the threads of one tap
//!     │   ·  · ╱·╱· ·               w with its standard error: threads differ by chance, too
//!     │ · ╱·  ·
//!     └───────────────────► x       length of thread that the tap has cut
//! ```
//!
//! A tap gets duller with the length of thread that it has cut, and needs more torque. Whether a rise is wear or chance
//! is a question of how much the threads scatter: the trend says both, and calls it wear only when the rise is
//! twice its own standard error.
use crate::feature::{Feature, FeatureKind, Thread};
use units::{Length, Torque};

/// A slope of so many standard errors is believed.
const BELIEVED: f64 = 2.0;
/// Threads below which no trend is fitted.
const FEWEST: usize = 3;

/// What the threads of one tap say.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueTrend {
    /// The tap.
    pub tool: u32,
    /// Size of its threads.
    pub size: String,
    /// By thread, in the order cut: thread that it had cut before and with it, torque in, torque out.
    pub threads: Vec<(Length, Torque, Option<Torque>)>,
    /// What the tap makers' formula expects on the way in.
    pub expected: Option<Torque>,
    /// M₀: torque of the tap before its first thread, by the fit.
    pub at_start: Torque,
    /// w: rise by metre of thread, as a share of M₀; `None` with too few threads for a fit.
    pub rise_per_m: Option<f64>,
    /// Standard error of w.
    pub uncertainty_per_m: f64,
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
        self.rise_per_m.is_some_and(|rise| rise > BELIEVED * self.uncertainty_per_m)
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
        }
    }

    fn take(&mut self, thread: &Thread, torque: Torque) {
        let before = self.threads.last().map_or(Length::ZERO, |(cut, ..)| *cut);
        self.threads.push((before + thread.tip_depth, torque, thread.torque_out));
    }

    fn fit(&mut self) {
        let points: Vec<(f64, f64)> =
            self.threads.iter().map(|(cut, m, _)| (cut.value() * 1e-3, m.value())).collect();
        let n = points.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let spread: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
        self.at_start = Torque::n_m(y);
        if points.len() < FEWEST || spread <= 0.0 {
            return;
        }
        let slope = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / spread;
        let left: f64 = points.iter().map(|p| (p.1 - y - slope * (p.0 - x)).powi(2)).sum();
        let start = y - slope * x;
        if start <= 0.0 {
            return;
        }
        self.at_start = Torque::n_m(start);
        self.rise_per_m = Some(slope / start);
        self.uncertainty_per_m = (left / (n - 2.0) / spread).sqrt() / start;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tap that cuts 20 mm deep threads, with these torques.
    fn trend(torques: &[f64]) -> TorqueTrend {
        let mut cut = Length::ZERO;
        let threads = torques.iter().map(|m| {
            cut += Length::mm(20.0);
            (cut, Torque::n_m(*m), None)
        });
        let mut trend = TorqueTrend {
            tool: 3,
            size: "M6x1".into(),
            threads: threads.collect(),
            expected: None,
            at_start: Torque::ZERO,
            rise_per_m: None,
            uncertainty_per_m: 0.0,
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
}

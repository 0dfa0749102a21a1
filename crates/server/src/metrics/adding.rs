//! Adds metrics to a registry.
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::{Family, MetricConstructor};
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::{Metric, Registry, Unit};
use std::sync::atomic::AtomicU64;

pub(super) type Labels = Vec<(&'static str, String)>;
pub(super) type Level = Gauge<f64, AtomicU64>;
pub(super) type Binned = Family<Labels, Histogram, BinEnds>;

/// A histogram with these upper ends.
#[derive(Clone, Copy)]
pub(super) struct BinEnds(pub(super) &'static [f64]);

impl MetricConstructor<Histogram> for BinEnds {
    fn new_metric(&self) -> Histogram {
        Histogram::new(self.0.iter().copied())
    }
}

/// Adds metrics to a registry, and gives each back.
pub(super) struct Adding<'a>(pub(super) &'a mut Registry);

impl Adding<'_> {
    pub(super) fn one<M: Metric + Clone>(&mut self, name: &str, help: &str, metric: M) -> M {
        self.0.register(name, help, metric.clone());
        metric
    }

    pub(super) fn of<M: Metric + Clone>(
        &mut self,
        (name, unit): (&str, Unit),
        help: &str,
        metric: M,
    ) -> M {
        self.0.register_with_unit(name, help, unit, metric.clone());
        metric
    }

    pub(super) fn level(&mut self, name: (&str, Unit), help: &str) -> Level {
        self.of(name, help, Level::default())
    }

    pub(super) fn counter(&mut self, name: &str, help: &str) -> Counter {
        self.one(name, help, Counter::default())
    }

    pub(super) fn bins(&mut self, name: (&str, Unit), help: &str, bins: BinEnds) -> Binned {
        self.of(name, help, Family::new_with_constructor(bins))
    }
}

/// A counter that is counted elsewhere.
pub(super) fn raise(counter: &Counter, to: u64) {
    counter.inc_by(to.saturating_sub(counter.get()));
}

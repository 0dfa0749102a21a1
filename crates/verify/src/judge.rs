//! The judge: takes ops and recorded samples in order, gives features.
use crate::{Config, Feature};
use bus::Sample;
use canon::Op;

/// Judges a workpiece from recorded motion.
#[derive(Debug)]
pub struct Judge {
    #[allow(dead_code)] // read by the tracks
    config: Config,
    features: Vec<Feature>,
}

impl Judge {
    /// A judge who has seen nothing yet.
    pub fn new(config: Config) -> Self {
        Self { config, features: Vec::new() }
    }

    /// What the program orders: each op once, in order, before its samples arrive.
    pub fn op(&mut self, _index: u32, _op: &Op) {}

    /// What happened: every servo period, in order.
    pub fn sample(&mut self, _sample: &Sample) {}

    /// The features, in the order cut.
    #[must_use]
    pub fn finish(self) -> Vec<Feature> {
        self.features
    }
}

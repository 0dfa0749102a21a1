//! How one value of a machine, a tool or a workpiece varies about what is said of it.
//!
//! ```text
//!   uniform      ┌────────────┐          triangular     ╱╲              normal     _╱‾╲_       cut off at ±3·d
//!               −d            d                       −d  d                      −d    d
//! ```

/// Farthest draw of a normal distribution, in standard deviations.
pub const FARTHEST_DEVIATIONS: f64 = 3.0;

/// How values are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Evenly, to either side.
    Uniform,
    /// From the middle, where it is likeliest, down to nothing on either side.
    Triangular,
    /// Of Gauss, cut off at [`FARTHEST_DEVIATIONS`].
    Normal,
}

/// From what to what a value varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// Each machine has its own.
    Machine,
    /// Each workpiece: with it the machine's state, its tools and the material.
    Part,
    /// Each hole.
    Hole,
}

/// How a value varies about what its model says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// To either side; of a normal distribution one standard deviation. In the value's own unit, or
    /// as a share of it.
    pub by: f64,
    /// How.
    pub distribution: Distribution,
    /// From what to what.
    pub per: Per,
}

impl Spread {
    /// As its model says.
    pub const NONE: Self = Self::uniform(0.0);

    /// Evenly to either side, from machine to machine.
    pub const fn uniform(by: f64) -> Self {
        Self { by, distribution: Distribution::Uniform, per: Per::Machine }
    }

    /// Farthest to either side.
    pub fn most(&self) -> f64 {
        match self.distribution {
            Distribution::Uniform | Distribution::Triangular => self.by,
            Distribution::Normal => self.by * FARTHEST_DEVIATIONS,
        }
    }
}

//! Encoders: what the machine believes of itself.
//!
//! ```text
//!   true   ─────╱        reading q = floor(x/q₀)·q₀        a spindle's disk may sit off centre:
//!   read   ──┘▔▔         never ahead of x, never more      x = θ + e·sin 2πθ
//!                        than q₀ behind (noise apart)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | x | true position | mm or rev |
//! | q₀ | one count | mm or rev |
//! | e | amplitude of the eccentricity | rev |
//!
//! The index mark of a spindle passes at whole revolutions of its disk. The counter is latched
//! there, and a mark may be crossed in either direction.
use crate::rng::Rng;
use units::{Angle, Coordinate};

/// Where an axis is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AxisEncoder {
    /// On the motor: sees neither backlash nor the stretch of the screw.
    Motor {
        /// Counts per turn of the motor.
        counts_per_rev: u32,
    },
    /// On the table.
    Scale {
        /// One count.
        resolution: Coordinate,
        /// Counts per turn of the encoder that the motor has beside it; a linear motor has none.
        motor_counts_per_rev: Option<u32>,
    },
}

/// How a spindle is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleEncoder {
    /// Counts per turn.
    pub counts_per_rev: u32,
    /// Amplitude of the reading's error, once per turn, from a disk off centre.
    pub eccentricity: Angle,
    /// Angle by which that error leads the spindle's: e·(sin(θ + φ) − sin φ).
    pub eccentric_at: Angle,
    /// Noise on the reading: so many counts to each side at most.
    pub noise_counts: f64,
}

/// One count below or at a position.
pub(crate) fn quantise(x: f64, count: f64) -> f64 {
    (x / count).floor() * count
}

impl SpindleEncoder {
    /// Where its disk stands at a true angle, both in revolutions.
    pub(crate) fn disk(&self, angle_rev: f64) -> f64 {
        if self.eccentricity == Angle::ZERO {
            return angle_rev;
        }
        let (turned, phase) = (Angle::rev(angle_rev).in_rad(), self.eccentric_at.in_rad());
        angle_rev + self.eccentricity.value() * ((turned + phase).sin() - phase.sin())
    }

    /// What it reads of its disk.
    pub(crate) fn read(&self, disk_rev: f64, rng: &mut Rng) -> f64 {
        let counts = f64::from(self.counts_per_rev);
        let noise = if self.noise_counts > 0.0 { self.noise_counts * rng.signed() } else { 0.0 };
        // divide by the whole number of counts rather than multiply by a rounded 1/counts
        (disk_rev * counts + noise).floor() / counts
    }
}

/// The index mark that lies between two positions of the disk, if one does; of several, the last
/// one passed.
pub(crate) fn index_between(before_rev: f64, after_rev: f64) -> Option<f64> {
    let (from, to) = (before_rev.floor(), after_rev.floor());
    if to > from {
        Some(to)
    } else if to < from {
        Some(to + 1.0)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::{prop_assert, proptest};

    fn encoder(counts_per_rev: u32) -> SpindleEncoder {
        SpindleEncoder {
            counts_per_rev,
            eccentricity: Angle::ZERO,
            eccentric_at: Angle::ZERO,
            noise_counts: 0.0,
        }
    }

    #[test]
    fn the_index_passes_once_a_turn_in_either_direction() {
        assert_eq!(index_between(0.9, 1.1), Some(1.0));
        assert_eq!(index_between(1.1, 0.9), Some(1.0));
        assert_eq!(index_between(1.1, 1.9), None);
        assert_eq!(index_between(-0.1, 0.1), Some(0.0));
        assert_eq!(index_between(0.1, -0.1), Some(0.0));
    }

    #[test]
    fn an_eccentric_disk_errs_by_its_amplitude_once_a_turn() {
        let disk = SpindleEncoder { eccentricity: Angle::rev(1e-4), ..encoder(1 << 24) };
        let mut rng = Rng::new(0);
        for (angle, error) in [(0.0, 0.0), (0.25, 1e-4), (0.5, 0.0), (0.75, -1e-4)] {
            let read = disk.read(disk.disk(angle), &mut rng) - angle;
            assert!((read - error).abs() < 1e-7, "{angle}: {read}");
        }
    }

    proptest! {
        #[test]
        fn a_reading_is_never_ahead_and_never_a_count_behind(x in -1e4..1e4_f64, counts in 1_u32..5_000_000) {
            let read = encoder(counts).read(x, &mut Rng::new(1));
            let behind = (x - read) * f64::from(counts);
            prop_assert!((-1e-6..1.0 + 1e-6).contains(&behind), "{behind}");
        }

        #[test]
        fn a_scale_reads_whole_counts(x in -2000.0..2000.0_f64, count in 1e-6..0.1_f64) {
            let read = quantise(x, count);
            prop_assert!(x - read >= -1e-9 && x - read < count + 1e-9);
            prop_assert!((read / count - (read / count).round()).abs() < 1e-4);
        }
    }
}
